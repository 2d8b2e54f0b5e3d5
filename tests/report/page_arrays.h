// page_arrays.h – a reader of packed arrays that shares nothing with the writer.
#pragma once
#include <zlib.h>

#include <cstdint>
#include <cstring>
#include <stdexcept>
#include <string>
#include <vector>

namespace dea::test {

inline std::string from_base64(const std::string& text) {
  std::string out;
  unsigned bits = 0;
  int held = 0;
  for (char c : text) {
    if (c == '=') break;
    unsigned digit = 0;
    if (c >= 'A' && c <= 'Z')
      digit = static_cast<unsigned>(c - 'A');
    else if (c >= 'a' && c <= 'z')
      digit = static_cast<unsigned>(c - 'a') + 26;
    else if (c >= '0' && c <= '9')
      digit = static_cast<unsigned>(c - '0') + 52;
    else if (c == '+')
      digit = 62;
    else if (c == '/')
      digit = 63;
    else
      throw std::runtime_error("not base64");
    bits = bits << 6 | digit;
    held += 6;
    if (held >= 8) {
      held -= 8;
      out += static_cast<char>(bits >> held & 0xffu);
    }
  }
  return out;
}

inline std::vector<std::uint32_t> words(const std::string& base64, std::size_t count, int bytes, bool delta) {
  const std::string packed = from_base64(base64);
  std::string planes(count * static_cast<std::size_t>(bytes), '\0');
  uLongf size = static_cast<uLongf>(planes.size());
  if (uncompress(reinterpret_cast<Bytef*>(planes.data()), &size, reinterpret_cast<const Bytef*>(packed.data()),
                 static_cast<uLong>(packed.size())) != Z_OK ||
      size != planes.size())
    throw std::runtime_error("does not inflate to its size");
  std::vector<std::uint32_t> out;
  const std::uint32_t mask = bytes == 2 ? 0xffffu : 0xffffffffu;
  std::uint32_t before = 0;
  for (std::size_t i = 0; i < count; ++i) {
    std::uint32_t word = 0;
    for (int k = 0; k < bytes; ++k)
      word |= static_cast<std::uint32_t>(static_cast<unsigned char>(planes[static_cast<std::size_t>(k) * count + i]))
              << (8 * k);
    before = delta ? (before + word) & mask : word;
    out.push_back(before);
  }
  return out;
}

/// Of an array as the page's JSON describes it.
template <class Json>
std::vector<double> integers(const std::string& base64, const Json& about) {
  std::vector<double> out;
  for (std::uint32_t word : words(base64, about["count"], about["bytes"], about["delta"])) out.push_back(word);
  return out;
}
template <class Json>
std::vector<double> floats(const std::string& base64, const Json& about) {
  std::vector<double> out;
  for (std::uint32_t word : words(base64, about["count"], about["bytes"], about["delta"])) {
    float x = 0;
    std::memcpy(&x, &word, sizeof x);
    out.push_back(static_cast<double>(x));
  }
  return out;
}

}  // namespace dea::test
