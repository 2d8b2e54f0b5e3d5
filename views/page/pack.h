// views/page/pack.h – arrays as text inside a page: byte planes, zlib, base64. page/data.js reads them.
#pragma once
#include <cstdint>
#include <string>
#include <vector>

namespace dea {

/// An array as it stands in the page.
///
/// Bytes of `base64` after inflating: elements of `bytes` bytes, little endian, as planes: first all lowest bytes, ...,
/// last all highest ones (like lies beside like, zlib finds more). `delta`: every element but the first is the
/// difference from the one before it, modulo 2^(8 bytes).
struct PackedArray {
  std::string base64;
  std::size_t count = 0;  ///< elements
  int bytes = 4;
  bool delta = false;
  bool real = false;  ///< 4-byte floats; otherwise integers
};

/// Indices, -1 included, as differences.
PackedArray pack_integers(const std::vector<std::int32_t>& values);
/// Floats, exact. NaN is kept.
PackedArray pack_floats(const std::vector<float>& values);

/// One code of 16 bits per value:
///     value = least + code * (most - least) / 65534,   65535: undefined (NaN)
/// so values come back within half a step, (most - least) / 131068, but for those above `least` by less than half a
/// step: they get code 1, not 0, because what is pressed must not look as if it were not; they come back within a step.
/// All values must be NaN or finite.
struct Codes {
  std::vector<std::uint16_t> codes;
  double least = 0.0, most = 0.0;
};
Codes quantise(const std::vector<double>& values);

PackedArray pack_codes(const std::vector<std::uint16_t>& codes);

}  // namespace dea
