// io/files/encoded_text.h – bytes and names as text inside other text, and bytes as a zlib stream.
#pragma once
#include <optional>
#include <string>
#include <string_view>

namespace dea {

/// RFC 4648, with padding.
std::string base64(const std::string& bytes);

/// The bytes again. Nothing: it is no base64, or has white space.
std::optional<std::string> bytes_of_base64(std::string_view text);

/// With zlib's default effort.
std::string packed_bytes(const std::string& bytes);

/// The bytes again; nothing: the stream is damaged.
std::optional<std::string> unpacked_bytes(const std::string& stream);
/// The same where their number is known; nothing, too: there are more or fewer.
std::optional<std::string> unpacked_bytes(const std::string& stream, std::size_t size);

/// The text with every byte that is no UTF-8 replaced by U+FFFD: names in plot files may be in any encoding.
std::string utf8(const std::string& text);

/// Text that is no markup, in XML and HTML: between tags or in an attribute within double quotes. Line breaks and tabs,
/// which readers take for spaces there, are written as FEBio knows them, "&#10;".
std::string escaped(std::string_view text);

}  // namespace dea
