#include "views/map/svg_text.h"

#include <fmt/format.h>

#include "io/files/encoded_text.h"

namespace dea {

std::string svg_text(const SvgText& look, const std::string& place, const std::string& text, const std::string& more) {
  std::string escaped;
  for (char c : utf8(text)) {
    if (c == '&' || c == '<' || c == '>')
      escaped += c == '&' ? "&amp;" : c == '<' ? "&lt;" : "&gt;";
    else if (static_cast<unsigned char>(c) >= 0x20)
      escaped += c;
  }
  return fmt::format("<text {} font-size=\"{:.7g}\"{} fill=\"{}\"{}{}>{}</text>\n", place, look.size,
                     look.bold ? " font-weight=\"bold\"" : "", hex(look.colour),
                     look.alpha < 1 ? fmt::format(" fill-opacity=\"{:g}\"", look.alpha) : "", more, escaped);
}

std::string svg_seam(const Rgb& paper) {
  return fmt::format(
      " stroke=\"{}\" stroke-opacity=\"0.85\" stroke-width=\"3.5\" stroke-linejoin=\"round\" "
      "paint-order=\"stroke\"",
      hex(paper));
}

}  // namespace dea
