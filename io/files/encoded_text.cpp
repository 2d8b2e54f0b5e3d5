#include "io/files/encoded_text.h"

#include <fmt/format.h>
#include <zlib.h>

#include <algorithm>
#include <cstdint>
#include <new>
#include <nlohmann/json.hpp>

namespace dea {

std::string base64(const std::string& bytes) {
  constexpr char kDigits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string out;
  out.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const std::size_t n = std::min<std::size_t>(3, bytes.size() - i);
    unsigned word = 0;
    for (std::size_t k = 0; k < 3; ++k) word = word << 8 | (k < n ? static_cast<unsigned char>(bytes[i + k]) : 0u);
    for (std::size_t k = 0; k < 4; ++k) out += k <= n ? kDigits[word >> (18 - 6 * k) & 63u] : '=';
  }
  return out;
}

std::optional<std::string> bytes_of_base64(std::string_view text) {
  std::string out;
  unsigned word = 0;
  int digits = 0, padding = 0;
  for (const char c : text) {
    const int value = c >= 'A' && c <= 'Z'   ? c - 'A'
                      : c >= 'a' && c <= 'z' ? c - 'a' + 26
                      : c >= '0' && c <= '9' ? c - '0' + 52
                      : c == '+'             ? 62
                      : c == '/'             ? 63
                      : c == '='             ? 0
                                             : -1;
    padding += c == '=';
    if (value < 0 || (padding > 0 && c != '=') || padding > 2) return std::nullopt;
    word = word << 6 | static_cast<unsigned>(value);
    if (++digits % 4 != 0) continue;
    for (const int shift : {16, 8, 0}) out += static_cast<char>(word >> shift & 0xffu);
    word = 0;
  }
  if (digits % 4 != 0) return std::nullopt;
  out.resize(out.size() - static_cast<std::size_t>(padding));
  return out;
}

std::string packed_bytes(const std::string& bytes) {
  uLongf size = compressBound(static_cast<uLong>(bytes.size()));
  std::string result(size, '\0');
  const int code =
      compress2(reinterpret_cast<Bytef*>(result.data()), &size, reinterpret_cast<const Bytef*>(bytes.data()),
                static_cast<uLong>(bytes.size()), Z_DEFAULT_COMPRESSION);
  if (code != Z_OK) throw std::bad_alloc();
  result.resize(size);
  return result;
}

namespace {

/// zlib's code; `size`: of `result`, then of what was unpacked into it.
int unpack(const std::string& stream, std::string& result, uLongf& size) {
  result.resize(size);
  return uncompress(reinterpret_cast<Bytef*>(result.data()), &size, reinterpret_cast<const Bytef*>(stream.data()),
                    static_cast<uLong>(stream.size()));
}

}  // namespace

std::optional<std::string> unpacked_bytes(const std::string& stream, std::size_t size) {
  std::string result;
  uLongf found = size;
  if (unpack(stream, result, found) != Z_OK || found != size) return std::nullopt;
  return result;
}

std::optional<std::string> unpacked_bytes(const std::string& stream) {
  constexpr std::uint64_t kMost = std::uint64_t{1} << 32;
  std::string result;
  for (std::uint64_t room = 4 * stream.size() + 64; room < kMost; room *= 4) {
    uLongf size = static_cast<uLongf>(room);
    const int code = unpack(stream, result, size);
    if (code == Z_BUF_ERROR && size == room) continue;  // not enough room
    if (code != Z_OK) return std::nullopt;
    result.resize(size);
    return result;
  }
  return std::nullopt;
}

std::string utf8(const std::string& text) {
  using nlohmann::json;
  return json::parse(json(text).dump(-1, ' ', false, json::error_handler_t::replace)).get<std::string>();
}

std::string escaped(std::string_view text) {
  std::string out;
  for (char c : text) {
    if (c == '&')
      out += "&amp;";
    else if (c == '<')
      out += "&lt;";
    else if (c == '>')
      out += "&gt;";
    else if (c == '"')
      out += "&quot;";
    else if (c == '\n' || c == '\r' || c == '\t')
      out += fmt::format("&#{};", static_cast<int>(c));
    else
      out += c;
  }
  return out;
}

}  // namespace dea
