#include "views/page/pack.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include "io/files/encoded_text.h"

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
  double least = std::numeric_limits<double>::infinity(), most = -least;
  for (double x : values) {
    if (std::isnan(x)) continue;
    least = std::min(least, x);
    most = std::max(most, x);
  }
  if (least > most) least = most = 0.0;
  out.least = least;
  out.most = most;
  out.codes.reserve(values.size());
  for (double x : values) {
    if (std::isnan(x)) {
      out.codes.push_back(kUndefined);
      continue;
    }
    if (!(x > least)) {
      out.codes.push_back(0);
      continue;
    }
    // halves: the difference of two large numbers must not overflow
    const double fraction = (0.5 * x - 0.5 * least) / (0.5 * most - 0.5 * least);
    out.codes.push_back(static_cast<std::uint16_t>(std::clamp(std::round(kSteps * fraction), 1.0, kSteps)));
  }
  return out;
}

PackedArray pack_codes(const std::vector<std::uint16_t>& codes) { return pack(codes, true); }

}  // namespace dea
