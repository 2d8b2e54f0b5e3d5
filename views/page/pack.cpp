#include "views/page/pack.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "io/files/encoded_text.h"
#include "views/map/map_scale.h"

namespace dea {

namespace {

constexpr std::uint16_t kUndefined = 65535;
constexpr double kSteps = 65534.0;

template <typename Word>
PackedArray pack(const std::vector<Word>& words, bool delta) {
  PackedArray packed;
  packed.count = words.size();
  packed.bytes = static_cast<int>(sizeof(Word));
  packed.delta = delta;
  std::string planes(words.size() * sizeof(Word), '\0');
  Word before = 0;
  for (std::size_t i = 0; i < words.size(); ++i) {
    const Word word = delta ? static_cast<Word>(words[i] - before) : words[i];
    before = words[i];
    for (std::size_t k = 0; k < sizeof(Word); ++k)
      planes[k * words.size() + i] = static_cast<char>(word >> (8 * k) & 0xffu);
  }
  packed.base64 = base64(packed_bytes(planes));
  return packed;
}

}  // namespace

PackedArray pack_integers(const std::vector<std::int32_t>& values) {
  return pack(std::vector<std::uint32_t>(values.begin(), values.end()), true);
}

PackedArray pack_floats(const std::vector<float>& values) {
  std::vector<std::uint32_t> words(values.size());
  if (!values.empty()) std::memcpy(words.data(), values.data(), values.size() * sizeof(float));
  PackedArray packed = pack(words, false);
  packed.real = true;
  return packed;
}

Codes quantise(const std::vector<double>& values) {
  Codes out;
  ValueRange range;
  range.add(values);
  if (range.empty()) range.add(0.0);
  out.least = range.least;
  out.most = range.most;
  out.codes.reserve(values.size());
  for (double x : values) {
    // halves: the difference of two large numbers must not overflow
    const double fraction = (0.5 * x - 0.5 * out.least) / (0.5 * out.most - 0.5 * out.least);
    if (std::isnan(x))
      out.codes.push_back(kUndefined);
    else
      out.codes.push_back(
          x > out.least ? static_cast<std::uint16_t>(std::clamp(std::round(kSteps * fraction), 1.0, kSteps)) : 0);
  }
  return out;
}

PackedArray pack_codes(const std::vector<std::uint16_t>& codes) { return pack(codes, true); }

}  // namespace dea
