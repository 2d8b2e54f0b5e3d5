#include "views/map/pen.h"

#include <cairo-pdf.h>
#include <cairo-svg.h>
#include <cairo.h>
#include <fmt/format.h>
#include <zlib.h>

#include <cctype>
#include <cmath>
#include <cstring>
#include <memory>
#include <stdexcept>

#include "io/files/encoded_text.h"
#include "io/results/existing_file.h"
#include "src/base/numbers.h"
#include "views/map/svg_text.h"

namespace dea {

struct Pen::Sheet {
  explicit Sheet(cairo_surface_t* surface) : cairo(cairo_create(surface), cairo_destroy) {
    cairo_set_line_join(get(), CAIRO_LINE_JOIN_ROUND);
    cairo_set_line_cap(get(), CAIRO_LINE_CAP_ROUND);
  }
  cairo_t* get() const { return cairo.get(); }

  std::unique_ptr<cairo_t, void (*)(cairo_t*)> cairo;
  SvgText look = {};                ///< of texts
  std::string* elements = nullptr;  ///< texts are not drawn, but added to them as <text> of SVG
};

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
  Pen::Sheet sheet(surface);
  sheet.elements = texts;
  cairo_scale(sheet.get(), zoom, zoom);
  // Outlines of letters, not of pixels: the same shapes on every paper.
  cairo_font_options_t* fonts = cairo_font_options_create();
  cairo_font_options_set_hint_style(fonts, CAIRO_HINT_STYLE_NONE);
  cairo_font_options_set_hint_metrics(fonts, CAIRO_HINT_METRICS_OFF);
  cairo_font_options_set_antialias(fonts, CAIRO_ANTIALIAS_GRAY);
  cairo_set_font_options(sheet.get(), fonts);
  cairo_font_options_destroy(fonts);
  Pen pen(sheet);
  draw(pen);
  require(cairo_status(sheet.get()));
}

void add_element(const Pen::Sheet& sheet, double x, double y, const std::string& text, const std::string& more) {
  cairo_matrix_t m;
  cairo_get_matrix(sheet.get(), &m);
  std::string place;
  if (m.xy == 0 && m.yx == 0 && m.xx == 1 && m.yy == 1) {
    place = fmt::format("x=\"{:.7g}\" y=\"{:.7g}\"", x + m.x0, y + m.y0);
  } else {
    cairo_matrix_transform_point(&m, &x, &y);
    place =
        fmt::format("transform=\"matrix({:.7g} {:.7g} {:.7g} {:.7g} {:.7g} {:.7g})\"", m.xx, m.yx, m.xy, m.yy, x, y);
  }
  *sheet.elements += svg_text(sheet.look, place, text, more);
}

}  // namespace

bool draws_pixels() { return true; }

void Pen::use(const Rgb& c, double alpha) {
  sheet_.look.colour = c;
  sheet_.look.alpha = alpha;
  cairo_set_source_rgba(sheet_.get(), c.r, c.g, c.b, alpha);
}

void Pen::font(double size, bool bold) {
  sheet_.look.size = size;
  sheet_.look.bold = bold;
  cairo_select_font_face(sheet_.get(), "sans-serif", CAIRO_FONT_SLANT_NORMAL,
                         bold ? CAIRO_FONT_WEIGHT_BOLD : CAIRO_FONT_WEIGHT_NORMAL);
  cairo_set_font_size(sheet_.get(), size);
}

double Pen::width(const std::string& text) const {
  cairo_text_extents_t e;
  cairo_text_extents(sheet_.get(), utf8(text).c_str(), &e);
  return e.x_advance;
}

void Pen::text_on(double x, double y, const std::string& text, const Rgb& paper) {
  const Rgb ink = sheet_.look.colour;
  if (sheet_.elements != nullptr) {
    add_element(sheet_, x, y, text, svg_seam(paper));
    return;
  }
  cairo_move_to(sheet_.get(), x, y);
  cairo_text_path(sheet_.get(), utf8(text).c_str());
  use(paper, 0.85);
  stroke_first(3.5);
  use(ink);
  fill();
}

void Pen::text(double x, double y, const std::string& text) {
  if (sheet_.elements != nullptr) {
    add_element(sheet_, x, y, text, "");
    return;
  }
  cairo_move_to(sheet_.get(), x, y);
  cairo_show_text(sheet_.get(), utf8(text).c_str());
}

void Pen::rectangle(double x, double y, double w, double h) {
  box(x, y, w, h);
  fill();
}

void Pen::all() { cairo_paint(sheet_.get()); }

void Pen::move_to(const Eigen::Vector2d& to) { cairo_move_to(sheet_.get(), to.x(), to.y()); }
void Pen::line_to(const Eigen::Vector2d& to) { cairo_line_to(sheet_.get(), to.x(), to.y()); }
void Pen::close() { cairo_close_path(sheet_.get()); }

void Pen::line(const Eigen::Vector2d& from, const Eigen::Vector2d& to) {
  move_to(from);
  line_to(to);
}

void Pen::triangle(const Eigen::Vector2d& a, const Eigen::Vector2d& b, const Eigen::Vector2d& c) {
  line(a, b);
  line_to(c);
  close();
}

void Pen::circle(const Eigen::Vector2d& center, double radius) { arc(center, radius, 0, 2 * kPi); }

void Pen::arc(const Eigen::Vector2d& center, double radius, double from, double to) {
  cairo_new_sub_path(sheet_.get());
  cairo_arc(sheet_.get(), center.x(), center.y(), radius, from, to);
}

void Pen::box(double x, double y, double w, double h) { cairo_rectangle(sheet_.get(), x, y, w, h); }

void Pen::stroke(double line_width) {
  cairo_set_line_width(sheet_.get(), line_width);
  cairo_stroke(sheet_.get());
}

void Pen::stroke_first(double line_width) {
  cairo_set_line_width(sheet_.get(), line_width);
  cairo_stroke_preserve(sheet_.get());
}

void Pen::fill() { cairo_fill(sheet_.get()); }

void Pen::dashed(double dash, double gap) {
  const double dashes[] = {dash, gap};
  cairo_set_dash(sheet_.get(), dashes, 2, 0.0);
}

void Pen::undashed() { cairo_set_dash(sheet_.get(), nullptr, 0, 0.0); }

void Pen::save() { cairo_save(sheet_.get()); }
void Pen::restore() { cairo_restore(sheet_.get()); }
void Pen::shift(double x, double y) { cairo_translate(sheet_.get(), x, y); }
void Pen::turn(double angle) { cairo_rotate(sheet_.get(), angle); }
void Pen::zoom(double factor) { cairo_scale(sheet_.get(), factor, factor); }

void Pen::clip(double x, double y, double w, double h) {
  box(x, y, w, h);
  cairo_clip(sheet_.get());
}

void measured(const std::function<void(Pen&)>& measure) {
  const SurfaceHolder probe(cairo_image_surface_create(CAIRO_FORMAT_RGB24, 1, 1), cairo_surface_destroy);
  Pen::Sheet sheet(probe.get());
  Pen pen(sheet);
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

}  // namespace dea
