// io/files/packed_bytes.h – bytes as a zlib stream.
#pragma once
#include <optional>
#include <string>

namespace dea {

/// With zlib's default effort.
std::string packed_bytes(const std::string& bytes);

/// The bytes again; nothing: the stream is damaged.
std::optional<std::string> unpacked_bytes(const std::string& stream);
/// The same where their number is known; nothing, too: there are more or fewer.
std::optional<std::string> unpacked_bytes(const std::string& stream, std::size_t size);

}  // namespace dea
