// io/encoded_text.h – bytes and names as text inside other text.
#pragma once
#include <string>

namespace dea {

/// RFC 4648, with padding.
std::string base64(const std::string& bytes);

/// Text that is no markup, in XML and HTML: between tags or in an attribute within double quotes.
std::string escaped(const std::string& text);

}  // namespace dea
