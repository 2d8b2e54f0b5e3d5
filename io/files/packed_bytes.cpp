#include "io/files/packed_bytes.h"

#include <zlib.h>

#include <new>

namespace dea {

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
  std::string result;
  for (std::size_t room = 4 * stream.size() + 64; room < (std::size_t{1} << 32); room *= 4) {
    uLongf size = room;
    const int code = unpack(stream, result, size);
    if (code == Z_BUF_ERROR && size == room) continue;  // not enough room
    if (code != Z_OK) return std::nullopt;
    result.resize(size);
    return result;
  }
  return std::nullopt;
}

}  // namespace dea
