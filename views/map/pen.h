// views/map/pen.h – Cairo's pens and papers. The only header that includes Cairo.
#pragma once
#include <cairo.h>

#include <Eigen/Core>
#include <functional>
#include <memory>
#include <string>

#include "views/map/colour_map.h"
#include "views/map/picture_format.h"

namespace dea {

/// Lengths on paper are in pixels of 1/96 inch, as in SVG; y is downwards.
class Pen {
 public:
  explicit Pen(cairo_surface_t* surface);
  cairo_t* get() const { return cairo_.get(); }

  void use(const Rgb& colour, double alpha = 1.0);
  void font(double size, bool bold = false);
  double width(const std::string& text) const;
  void text(double x, double y, const std::string& text);
  /// Amid lines and colours: on a seam of the colour of the paper.
  void text_on(double x, double y, const std::string& text, const Rgb& paper);
  void rectangle(double x, double y, double w, double h);
  void stroke(double line_width);
  // To be stroked or filled.
  void line(const Eigen::Vector2d& from, const Eigen::Vector2d& to);
  void triangle(const Eigen::Vector2d& a, const Eigen::Vector2d& b, const Eigen::Vector2d& c);
  void circle(const Eigen::Vector2d& center, double radius);
  /// Strokes from here on.
  void dashed(double dash, double gap);
  void undashed() { cairo_set_dash(get(), nullptr, 0, 0.0); }

  /// From here on texts are not drawn, but added to `elements` as <text> of SVG.
  void keep_texts(std::string* elements) { elements_ = elements; }

 private:
  void add_element(double x, double y, const std::string& text, const std::string& more) const;

  std::unique_ptr<cairo_t, void (*)(cairo_t*)> cairo_;
  Rgb colour_;
  double alpha_ = 1.0, size_ = 10.0;
  bool bold_ = false;
  std::string* elements_ = nullptr;
};

/// `measure` with a pen that leaves no trace: words have the same width on every paper.
void measured(const std::function<void(Pen&)>& measure);

struct PaperSize {
  PictureFormat format = PictureFormat::Svg;
  double width = 0.0, height = 0.0;
  double dpi = 200.0;  ///< of PNG
  bool text = false;   ///< SVG: letters are text, above all else
};
/// The bytes of a file with what `draw` draws; the same for the same strokes and fonts.
std::string drawn(const PaperSize& size, const std::function<void(Pen&)>& draw);
/// The same as pixels, those of a PNG.
Image drawn_image(const PaperSize& size, const std::function<void(Pen&)>& draw);

}  // namespace dea
