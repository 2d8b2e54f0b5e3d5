// views/map/pen.h without Cairo: what is drawn becomes elements of SVG, and letters are text.
#include <fmt/format.h>

#include <cmath>
#include <utility>
#include <vector>

#include "io/files/encoded_text.h"
#include "io/results/existing_file.h"
#include "src/base/error.h"
#include "src/base/numbers.h"
#include "views/map/pen.h"
#include "views/map/svg_text.h"

namespace dea {

struct Pen::Sheet {
  SvgText look = {};
  std::string elements, path, dashes;
  std::vector<int> groups = {0};  ///< open elements <g>, of each save
  int clips = 0;
};

namespace {

using Eigen::Vector2d;

std::string px(double x) { return fmt::format("{:.7g}", std::round(1000.0 * x) / 1000.0 + 0.0); }
std::string pair(const Vector2d& x) { return px(x.x()) + " " + px(x.y()); }

void open_group(Pen::Sheet& sheet, const std::string& attribute) {
  sheet.elements += fmt::format("<g {}>\n", attribute);
  ++sheet.groups.back();
}

void close_groups(Pen::Sheet& sheet) {
  for (; sheet.groups.back() > 0; --sheet.groups.back()) sheet.elements += "</g>\n";
}

/// Widths of letters of sans-serif fonts from ' ' to '~', in hundredths of their size: those of Helvetica and Arial and
/// an eighth more, for others are wider.
constexpr int kWidths[] = {31, 31, 40, 63, 63, 100, 75, 22, 37, 37, 44, 66, 31, 37,  31, 31, 63, 63,  63,
                           63, 63, 63, 63, 63, 63,  63, 31, 31, 66, 66, 66, 63, 114, 75, 75, 81, 81,  75,
                           69, 88, 81, 31, 56, 75,  63, 94, 81, 88, 75, 88, 81, 75,  69, 81, 75, 106, 75,
                           75, 69, 31, 31, 31, 53,  63, 37, 63, 63, 56, 63, 63, 31,  63, 63, 25, 25,  56,
                           25, 94, 63, 63, 63, 63,  37, 56, 31, 63, 56, 81, 56, 56,  56, 38, 29, 38,  66};
static_assert(std::size(kWidths) == 95);
constexpr int kOtherLetter = 63;
constexpr double kBoldIs = 1.07;  // times as wide

}  // namespace

bool draws_pixels() { return false; }

void Pen::use(const Rgb& c, double alpha) {
  sheet_.look.colour = c;
  sheet_.look.alpha = alpha;
}

void Pen::font(double size, bool bold) {
  sheet_.look.size = size;
  sheet_.look.bold = bold;
}

double Pen::width(const std::string& text) const {
  int hundredths = 0;
  for (const char c : utf8(text))
    if (c >= ' ' && c <= '~')
      hundredths += kWidths[c - ' '];
    else if ((static_cast<unsigned char>(c) & 0xC0) == 0xC0)  // the first byte of a letter
      hundredths += kOtherLetter;
  return 0.01 * hundredths * sheet_.look.size * (sheet_.look.bold ? kBoldIs : 1.0);
}

void Pen::text(double x, double y, const std::string& text) {
  sheet_.elements += svg_text(sheet_.look, fmt::format("x=\"{}\" y=\"{}\"", px(x), px(y)), text);
}

void Pen::text_on(double x, double y, const std::string& text, const Rgb& paper) {
  sheet_.elements += svg_text(sheet_.look, fmt::format("x=\"{}\" y=\"{}\"", px(x), px(y)), text, svg_seam(paper));
}

void Pen::rectangle(double x, double y, double w, double h) {
  box(x, y, w, h);
  fill();
}

void Pen::all() {
  sheet_.elements += fmt::format("<rect width=\"100%\" height=\"100%\" fill=\"{}\"/>\n", hex(sheet_.look.colour));
}

void Pen::move_to(const Vector2d& to) { sheet_.path += "M" + pair(to); }
void Pen::line_to(const Vector2d& to) { sheet_.path += "L" + pair(to); }
void Pen::close() { sheet_.path += "Z"; }

void Pen::line(const Vector2d& from, const Vector2d& to) {
  move_to(from);
  line_to(to);
}

void Pen::triangle(const Vector2d& a, const Vector2d& b, const Vector2d& c) {
  line(a, b);
  line_to(c);
  close();
}

void Pen::circle(const Vector2d& center, double radius) {
  arc(center, radius, 0, kPi);
  sheet_.path += fmt::format("A{0} {0} 0 0 1 {1}Z", px(radius), pair(center + Vector2d(radius, 0)));
}

void Pen::arc(const Vector2d& center, double radius, double from, double to) {
  const auto at_angle = [&](double angle) {
    return Vector2d(center + radius * Vector2d(std::cos(angle), std::sin(angle)));
  };
  move_to(at_angle(from));
  sheet_.path += fmt::format("A{0} {0} 0 {1} 1 {2}", px(radius), to - from > kPi ? 1 : 0, pair(at_angle(to)));
}

void Pen::box(double x, double y, double w, double h) {
  sheet_.path += fmt::format("M{} {}h{}v{}h{}Z", px(x), px(y), px(w), px(h), px(-w));
}

void Pen::stroke(double line_width) {
  stroke_first(line_width);
  sheet_.path.clear();
}

void Pen::stroke_first(double line_width) {
  const std::string alpha =
      sheet_.look.alpha < 1 ? fmt::format(" stroke-opacity=\"{:g}\"", sheet_.look.alpha) : std::string();
  sheet_.elements += fmt::format("<path d=\"{}\" fill=\"none\" stroke=\"{}\" stroke-width=\"{}\"{}{}/>\n", sheet_.path,
                                 hex(sheet_.look.colour), px(line_width), alpha, sheet_.dashes);
}

void Pen::fill() {
  const std::string alpha =
      sheet_.look.alpha < 1 ? fmt::format(" fill-opacity=\"{:g}\"", sheet_.look.alpha) : std::string();
  sheet_.elements += fmt::format("<path d=\"{}\" fill=\"{}\"{}/>\n", sheet_.path, hex(sheet_.look.colour), alpha);
  sheet_.path.clear();
}

void Pen::dashed(double dash, double gap) {
  sheet_.dashes = fmt::format(" stroke-dasharray=\"{} {}\"", px(dash), px(gap));
}

void Pen::undashed() { sheet_.dashes.clear(); }

void Pen::save() { sheet_.groups.push_back(0); }

void Pen::restore() {
  close_groups(sheet_);
  sheet_.groups.pop_back();
}

void Pen::shift(double x, double y) { open_group(sheet_, fmt::format("transform=\"translate({} {})\"", px(x), px(y))); }

void Pen::turn(double angle) {
  open_group(sheet_, fmt::format("transform=\"rotate({})\"", px(angle * kDegreesPerRadian)));
}

void Pen::zoom(double factor) {
  if (factor != 1.0) open_group(sheet_, fmt::format("transform=\"scale({:.7g})\"", factor));
}

void Pen::clip(double x, double y, double w, double h) {
  box(x, y, w, h);
  sheet_.elements += fmt::format("<clipPath id=\"clip{}\"><path d=\"{}\"/></clipPath>\n", ++sheet_.clips,
                                 std::exchange(sheet_.path, ""));
  open_group(sheet_, fmt::format("clip-path=\"url(#clip{})\"", sheet_.clips));
}

void measured(const std::function<void(Pen&)>& measure) {
  Pen::Sheet sheet;
  Pen pen(sheet);
  measure(pen);
}

std::string drawn(const PaperSize& size, const std::function<void(Pen&)>& draw) {
  Pen::Sheet sheet;
  Pen pen(sheet);
  draw(pen);
  close_groups(sheet);
  return fmt::format(
      "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
      "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0}px\" height=\"{1}px\" viewBox=\"0 0 {0} {1}\" "
      "font-family=\"sans-serif\" stroke-linecap=\"round\" stroke-linejoin=\"round\">\n{2}<!-- {3} -->\n</svg>\n",
      px(size.width), px(size.height), sheet.elements, kPictureMark);
}

Image drawn_image(const PaperSize&, const std::function<void(Pen&)>&) { throw UsageError(kSvgAlone); }

}  // namespace dea
