// views/map/pen.h – pens and papers: Cairo's (pen.cpp, which alone includes it), or text of SVG where there is no Cairo
// (pen_svg.cpp).
#pragma once
#include <Eigen/Core>
#include <functional>
#include <string>

#include "views/map/colour_map.h"
#include "views/map/picture_format.h"

namespace dea {

/// Lengths on paper are in pixels of 1/96 inch, as in SVG; y is downwards.
class Pen {
 public:
  struct Sheet;  ///< what is drawn on, and with what
  explicit Pen(Sheet& sheet) : sheet_(sheet) {}

  void use(const Rgb& colour, double alpha = 1.0);
  void font(double size, bool bold = false);
  double width(const std::string& text) const;
  void text(double x, double y, const std::string& text);
  /// Amid lines and colours: on a seam of the colour of the paper.
  void text_on(double x, double y, const std::string& text, const Rgb& paper);
  void rectangle(double x, double y, double w, double h);  ///< filled
  void all();                                              ///< the paper, filled

  // The path: to be stroked or filled, which ends it.
  void move_to(const Eigen::Vector2d& to);
  void line_to(const Eigen::Vector2d& to);
  void close();
  void line(const Eigen::Vector2d& from, const Eigen::Vector2d& to);
  void triangle(const Eigen::Vector2d& a, const Eigen::Vector2d& b, const Eigen::Vector2d& c);
  void circle(const Eigen::Vector2d& center, double radius);
  /// Clockwise as seen, from one angle [rad] to a larger one; 0 is to the right.
  void arc(const Eigen::Vector2d& center, double radius, double from, double to);
  void box(double x, double y, double w, double h);
  void stroke(double line_width);
  void stroke_first(double line_width);  ///< and the path is still there
  void fill();

  /// Strokes from here on.
  void dashed(double dash, double gap);
  void undashed();

  // Until restore: where things lie, and that nothing is seen outside of a box.
  void save();
  void restore();
  void shift(double x, double y);
  void turn(double angle);  ///< [rad], clockwise as seen
  void zoom(double factor);
  void clip(double x, double y, double w, double h);

 private:
  Sheet& sheet_;
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
