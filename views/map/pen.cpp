#include "views/map/pen.h"

#include <cairo-pdf.h>
#include <cairo-svg.h>
#include <fmt/format.h>
#include <zlib.h>

#include <cctype>
#include <cmath>
#include <cstring>
#include <stdexcept>

#include "io/files/encoded_text.h"
#include "io/files/output.h"
#include "io/results/existing_file.h"
#include "src/base/error.h"
#include "src/base/numbers.h"

namespace dea {

namespace {

cairo_status_t append(void* bytes, const unsigned char* data, unsigned int n) {
  static_cast<std::string*>(bytes)->append(reinterpret_cast<const char*>(data), n);
  return CAIRO_STATUS_SUCCESS;
}

/// Cairo numbers the drawings of a process; a file shall not depend on how many there were before.
void drop_number(std::string& svg) {
  const std::string word = "surface";
  for (std::size_t i = svg.find(word); i != std::string::npos; i = svg.find(word, i + word.size())) {
    std::size_t end = i + word.size();
    while (end < svg.size() && std::isdigit(static_cast<unsigned char>(svg[end]))) ++end;
    svg.erase(i + word.size(), end - i - word.size());
  }
}

/// A PNG with the mark as a chunk of text behind its head (PNG specification, 11.3.4).
void add_mark(std::string& png) {
  constexpr std::size_t kHead = 8 + 25;  // signature, IHDR
  const auto number = [](std::size_t n) {
    std::string bytes;
    for (const int shift : {24, 16, 8, 0}) bytes += static_cast<char>(n >> shift & 0xFF);
    return bytes;
  };
  std::string chunk = "tEXtComment";
  chunk += '\0';
  chunk += kPictureMark;
  const auto sum = crc32(0, reinterpret_cast<const unsigned char*>(chunk.data()), static_cast<uInt>(chunk.size()));
  png.insert(kHead, number(chunk.size() - 4) + chunk + number(sum));
}

void require(cairo_status_t status) {
  if (status != CAIRO_STATUS_SUCCESS)
    throw std::runtime_error(std::string("drawing failed: ") + cairo_status_to_string(status));
}

using SurfaceHolder = std::unique_ptr<cairo_surface_t, void (*)(cairo_surface_t*)>;

SurfaceHolder pixels(const PaperSize& size) {
  const double zoom = size.dpi / 96.0;
  SurfaceHolder surface(cairo_image_surface_create(CAIRO_FORMAT_RGB24, static_cast<int>(std::round(zoom * size.width)),
                                                   static_cast<int>(std::round(zoom * size.height))),
                        cairo_surface_destroy);
  require(cairo_surface_status(surface.get()));
  return surface;
}

/// `zoom`: from pixels of 1/96 inch to the surface's unit. `texts`: where texts go instead.
void draw_on(cairo_surface_t* surface, double zoom, const std::function<void(Pen&)>& draw,
             std::string* texts = nullptr) {
  require(cairo_surface_status(surface));
  Pen pen(surface);
  pen.keep_texts(texts);
  cairo_scale(pen.get(), zoom, zoom);
  // Outlines of letters, not of pixels: the same shapes on every paper.
  cairo_font_options_t* fonts = cairo_font_options_create();
  cairo_font_options_set_hint_style(fonts, CAIRO_HINT_STYLE_NONE);
  cairo_font_options_set_hint_metrics(fonts, CAIRO_HINT_METRICS_OFF);
  cairo_font_options_set_antialias(fonts, CAIRO_ANTIALIAS_GRAY);
  cairo_set_font_options(pen.get(), fonts);
  cairo_font_options_destroy(fonts);
  draw(pen);
  require(cairo_status(pen.get()));
}

}  // namespace

Pen::Pen(cairo_surface_t* surface) : cairo_(cairo_create(surface), cairo_destroy) {
  cairo_set_line_join(get(), CAIRO_LINE_JOIN_ROUND);
  cairo_set_line_cap(get(), CAIRO_LINE_CAP_ROUND);
}

void Pen::use(const Rgb& c, double alpha) {
  colour_ = c;
  alpha_ = alpha;
  cairo_set_source_rgba(get(), c.r, c.g, c.b, alpha);
}

void Pen::font(double size, bool bold) {
  size_ = size;
  bold_ = bold;
  cairo_select_font_face(get(), "sans-serif", CAIRO_FONT_SLANT_NORMAL,
                         bold ? CAIRO_FONT_WEIGHT_BOLD : CAIRO_FONT_WEIGHT_NORMAL);
  cairo_set_font_size(get(), size);
}

double Pen::width(const std::string& text) const {
  cairo_text_extents_t e;
  cairo_text_extents(get(), utf8(text).c_str(), &e);
  return e.x_advance;
}

void Pen::add_element(double x, double y, const std::string& text, const std::string& more) const {
  cairo_matrix_t m;
  cairo_get_matrix(get(), &m);
  std::string place;
  if (m.xy == 0 && m.yx == 0 && m.xx == 1 && m.yy == 1) {
    place = fmt::format("x=\"{:.7g}\" y=\"{:.7g}\"", x + m.x0, y + m.y0);
  } else {
    cairo_matrix_transform_point(&m, &x, &y);
    place =
        fmt::format("transform=\"matrix({:.7g} {:.7g} {:.7g} {:.7g} {:.7g} {:.7g})\"", m.xx, m.yx, m.xy, m.yy, x, y);
  }
  std::string escaped;
  for (char c : utf8(text)) {
    if (c == '&' || c == '<' || c == '>')
      escaped += c == '&' ? "&amp;" : c == '<' ? "&lt;" : "&gt;";
    else if (static_cast<unsigned char>(c) >= 0x20)
      escaped += c;
  }
  *elements_ += fmt::format("<text {} font-size=\"{:.7g}\"{} fill=\"{}\"{}{}>{}</text>\n", place, size_,
                            bold_ ? " font-weight=\"bold\"" : "", hex(colour_),
                            alpha_ < 1 ? fmt::format(" fill-opacity=\"{:g}\"", alpha_) : "", more, escaped);
}

void Pen::text_on(double x, double y, const std::string& text, const Rgb& paper) {
  const Rgb ink = colour_;
  if (elements_ != nullptr) {
    add_element(x, y, text,
                fmt::format(" stroke=\"{}\" stroke-opacity=\"0.85\" stroke-width=\"3.5\" stroke-linejoin=\"round\" "
                            "paint-order=\"stroke\"",
                            hex(paper)));
    return;
  }
  cairo_move_to(get(), x, y);
  cairo_text_path(get(), utf8(text).c_str());
  use(paper, 0.85);
  cairo_set_line_width(get(), 3.5);
  cairo_stroke_preserve(get());
  use(ink);
  cairo_fill(get());
}

void Pen::text(double x, double y, const std::string& text) {
  if (elements_ != nullptr) {
    add_element(x, y, text, "");
    return;
  }
  cairo_move_to(get(), x, y);
  cairo_show_text(get(), utf8(text).c_str());
}

void Pen::rectangle(double x, double y, double w, double h) {
  cairo_rectangle(get(), x, y, w, h);
  cairo_fill(get());
}

void Pen::stroke(double line_width) {
  cairo_set_line_width(get(), line_width);
  cairo_stroke(get());
}

void Pen::line(const Eigen::Vector2d& from, const Eigen::Vector2d& to) {
  cairo_move_to(get(), from.x(), from.y());
  cairo_line_to(get(), to.x(), to.y());
}

void Pen::triangle(const Eigen::Vector2d& a, const Eigen::Vector2d& b, const Eigen::Vector2d& c) {
  line(a, b);
  cairo_line_to(get(), c.x(), c.y());
  cairo_close_path(get());
}

void Pen::circle(const Eigen::Vector2d& center, double radius) {
  cairo_new_sub_path(get());
  cairo_arc(get(), center.x(), center.y(), radius, 0, 2 * kPi);
}

void Pen::dashed(double dash, double gap) {
  const double dashes[] = {dash, gap};
  cairo_set_dash(get(), dashes, 2, 0.0);
}

void measured(const std::function<void(Pen&)>& measure) {
  const SurfaceHolder probe(cairo_image_surface_create(CAIRO_FORMAT_RGB24, 1, 1), cairo_surface_destroy);
  Pen pen(probe.get());
  measure(pen);
}

std::string drawn(const PaperSize& size, const std::function<void(Pen&)>& draw) {
  std::string bytes;
  SurfaceHolder surface(nullptr, cairo_surface_destroy);
  double zoom = 1.0;
  if (size.format == PictureFormat::Svg) {
    surface.reset(cairo_svg_surface_create_for_stream(append, &bytes, size.width, size.height));
    cairo_svg_surface_set_document_unit(surface.get(), CAIRO_SVG_UNIT_PX);
  } else if (size.format == PictureFormat::Pdf) {
    zoom = 0.75;
    surface.reset(cairo_pdf_surface_create_for_stream(append, &bytes, zoom * size.width, zoom * size.height));
    cairo_pdf_surface_set_metadata(surface.get(), CAIRO_PDF_METADATA_CREATE_DATE, "2000-01-01T00:00:00Z");
    cairo_pdf_surface_set_metadata(surface.get(), CAIRO_PDF_METADATA_CREATOR, std::string(kPictureMark).c_str());
  } else {
    zoom = size.dpi / 96.0;
    surface = pixels(size);
  }
  const bool text = size.text && size.format == PictureFormat::Svg;
  std::string texts;
  draw_on(surface.get(), zoom, draw, text ? &texts : nullptr);
  if (size.format == PictureFormat::Png)
    require(cairo_surface_write_to_png_stream(surface.get(), append, &bytes));
  else
    cairo_surface_finish(surface.get());
  require(cairo_surface_status(surface.get()));
  if (size.format == PictureFormat::Svg) drop_number(bytes);  // no word of ours is in it yet
  if (text) bytes.insert(bytes.rfind("</svg>"), fmt::format("<g font-family=\"sans-serif\">\n{}</g>\n", texts));
  if (size.format == PictureFormat::Svg)
    bytes.insert(bytes.rfind("</svg>"), fmt::format("<!-- {} -->\n", kPictureMark));
  if (size.format == PictureFormat::Png) add_mark(bytes);
  return bytes;
}

Image drawn_image(const PaperSize& size, const std::function<void(Pen&)>& draw) {
  const SurfaceHolder surface = pixels(size);
  draw_on(surface.get(), size.dpi / 96.0, draw);
  cairo_surface_flush(surface.get());
  Image image;
  image.width = cairo_image_surface_get_width(surface.get());
  image.height = cairo_image_surface_get_height(surface.get());
  const std::size_t width = static_cast<std::size_t>(image.width), height = static_cast<std::size_t>(image.height),
                    stride = static_cast<std::size_t>(cairo_image_surface_get_stride(surface.get()));
  const unsigned char* data = cairo_image_surface_get_data(surface.get());
  image.rgb.reserve(3 * width * height);
  for (std::size_t y = 0; y < height; ++y)
    for (std::size_t x = 0; x < width; ++x) {
      std::uint32_t pixel;  // 0x00RRGGBB, whatever the order of bytes
      std::memcpy(&pixel, data + y * stride + 4 * x, 4);
      for (const int shift : {16, 8, 0}) image.rgb.push_back(static_cast<std::uint8_t>(pixel >> shift & 0xFF));
    }
  return image;
}

PictureFormat picture_format(const std::string& option, const std::string& path) {
  const std::string extension = extension_of(path);
  if (extension == ".png") return PictureFormat::Png;
  if (extension == ".svg") return PictureFormat::Svg;
  if (extension == ".pdf") return PictureFormat::Pdf;
  throw UsageError(wrong_ending(option, path, ".png, .svg or .pdf", ".png"));
}

}  // namespace dea
