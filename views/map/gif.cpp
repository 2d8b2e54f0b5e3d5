#include "views/map/gif.h"

#include <gif_lib.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <unordered_map>
#include <utility>

#include "io/results/existing_file.h"
#include "src/base/numbers.h"
#include "views/map/draw_map.h"
#include "views/map/map_scale.h"

namespace dea {

namespace {

constexpr std::size_t kColours = 256;

Rgb between(const Rgb& x, const Rgb& y, double t) {
  return {x.r + t * (y.r - x.r), x.g + t * (y.g - x.g), x.b + t * (y.b - x.b)};
}

Rgb rgb(const ByteColour& c) { return {c[0] / 255.0, c[1] / 255.0, c[2] / 255.0}; }

void require(int status, int error = 0) {
  if (status == GIF_ERROR) {
    const char* why = GifErrorString(error);
    throw std::runtime_error(std::string("GIF: ") + (why != nullptr ? why : "cannot be encoded"));
  }
}

/// What is not the same in two frames, as columns and rows [left, right), [top, bottom).
struct Changed {
  int left, top, right, bottom;
};

}  // namespace

std::vector<ByteColour> gif_palette(ColourMap map, bool dark) {
  const Paper p = paper(dark, map);
  const Rgb white = {1, 1, 1}, black = {0, 0, 0};
  std::vector<ByteColour> colours;
  for (int b = 0; b < kBands; ++b) colours.push_back(bytes(band_colour(map, b)));
  for (const Rgb& c : {p.background, p.text, p.faint, p.line, p.nothing, p.turned_away, white, black})
    colours.push_back(bytes(c));
  for (int b = 1; b < kBands; b += 2) {  // lines of equal value, three quarters white or black
    const Rgb under = band_colour(map, b);
    colours.push_back(bytes(between(under, white_line(under) ? white : black, 0.75)));
  }
  const std::size_t left = kColours - colours.size();
  for (std::size_t i = 1; i <= left; ++i)
    colours.push_back(bytes(between(p.background, p.text, static_cast<double>(i) / static_cast<double>(left + 1))));
  return colours;
}

struct GifWriter::State {
  Put put;
  std::vector<ByteColour> palette;
  std::vector<OkLab> looks;
  double fps = 1.0;
  int width = 0, height = 0;
  long frames = 0;
  std::string bytes;  ///< encoded, not yet put
  GifFileType* file = nullptr;
  std::unordered_map<std::uint32_t, std::uint8_t> known;  ///< colour: its place in the palette
  std::vector<GifPixelType> before;                       ///< the frame before

  std::uint8_t place(const std::uint8_t* c) {
    const std::uint32_t key = static_cast<std::uint32_t>(c[0]) << 16 | static_cast<std::uint32_t>(c[1]) << 8 | c[2];
    const auto found = known.find(key);
    if (found != known.end()) return found->second;
    const OkLab x = oklab(rgb({c[0], c[1], c[2]}));
    std::size_t best = 0;
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < looks.size(); ++i) {
      const OkLab& y = looks[i];
      const double d = (x.L - y.L) * (x.L - y.L) + (x.a - y.a) * (x.a - y.a) + (x.b - y.b) * (x.b - y.b);
      if (d < least) {
        least = d;
        best = i;
      }
    }
    return known[key] = static_cast<std::uint8_t>(best);
  }

  void flush() {
    put(bytes);
    bytes.clear();
  }

  void write_head(const Image& frame) {
    width = frame.width;
    height = frame.height;
    assert(palette.size() == kColours);
    const std::unique_ptr<ColorMapObject, void (*)(ColorMapObject*)> colours(
        GifMakeMapObject(static_cast<int>(kColours), nullptr), GifFreeMapObject);
    if (!colours) throw std::bad_alloc();
    for (std::size_t i = 0; i < kColours; ++i) colours->Colors[i] = {palette[i][0], palette[i][1], palette[i][2]};
    require(EGifPutScreenDesc(file, width, height, 8, 0, colours.get()), file->Error);
    require(EGifPutExtensionLeader(file, APPLICATION_EXT_FUNC_CODE), file->Error);
    require(EGifPutExtensionBlock(file, 11, "NETSCAPE2.0"), file->Error);
    const std::uint8_t for_ever[] = {1, 0, 0};
    require(EGifPutExtensionBlock(file, 3, for_ever), file->Error);
    require(EGifPutExtensionTrailer(file), file->Error);
    require(EGifPutComment(file, std::string(kPictureMark).c_str()), file->Error);
  }

  Changed changed(const std::vector<GifPixelType>& pixels) const {
    if (before.empty()) return {0, 0, width, height};
    Changed c = {width, height, 0, 0};
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < width; ++x) {
        const std::size_t i = at(y) * at(width) + at(x);
        if (pixels[i] == before[i]) continue;
        c = {std::min(c.left, x), std::min(c.top, y), std::max(c.right, x + 1), std::max(c.bottom, y + 1)};
      }
    return c.right > c.left ? c : Changed{0, 0, 1, 1};  // a frame that stands still has its time too
  }

  void write(std::vector<GifPixelType> pixels) {
    const auto hundredths = [&](long frame) { return std::lround(100.0 * static_cast<double>(frame) / fps); };
    GraphicsControlBlock control = {};
    control.DisposalMode = DISPOSE_DO_NOT;
    control.DelayTime = static_cast<int>(hundredths(frames + 1) - hundredths(frames));
    control.TransparentColor = NO_TRANSPARENT_COLOR;
    GifByteType extension[4];
    const std::size_t length = EGifGCBToExtension(&control, extension);
    require(EGifPutExtension(file, GRAPHICS_EXT_FUNC_CODE, static_cast<int>(length), extension), file->Error);
    const Changed c = changed(pixels);
    require(EGifPutImageDesc(file, c.left, c.top, c.right - c.left, c.bottom - c.top, false, nullptr), file->Error);
    for (int y = c.top; y < c.bottom; ++y) {
      // giflib masks the pixels it is given, in place: they stay what they are
      require(EGifPutLine(file, pixels.data() + at(y) * at(width) + at(c.left), c.right - c.left), file->Error);
    }
    before = std::move(pixels);
    ++frames;
  }
};

GifWriter::GifWriter(Put put, std::vector<ByteColour> palette, double fps) : state_(std::make_unique<State>()) {
  State& s = *state_;
  s.put = std::move(put);
  s.palette = std::move(palette);
  s.fps = fps;
  for (const ByteColour& c : s.palette) s.looks.push_back(oklab(rgb(c)));
  const auto collect = [](GifFileType* file, const GifByteType* data, int n) {
    static_cast<State*>(file->UserData)->bytes.append(reinterpret_cast<const char*>(data), static_cast<std::size_t>(n));
    return n;
  };
  int error = 0;
  s.file = EGifOpen(&s, collect, &error);
  require(s.file != nullptr ? GIF_OK : GIF_ERROR, error);
  EGifSetGifVersion(s.file, true);
}

GifWriter::~GifWriter() {
  if (state_->file != nullptr) EGifCloseFile(state_->file, nullptr);
}

void GifWriter::add(const Image& frame) {
  State& s = *state_;
  if (s.frames == 0) s.write_head(frame);
  assert(frame.width == s.width && frame.height == s.height);
  std::vector<GifPixelType> pixels(frame.rgb.size() / 3);
  for (std::size_t i = 0; i < pixels.size(); ++i) pixels[i] = s.place(frame.rgb.data() + 3 * i);
  s.write(std::move(pixels));
  s.flush();
}

void GifWriter::end() {
  State& s = *state_;
  GifFileType* file = std::exchange(s.file, nullptr);
  int error = 0;
  require(EGifCloseFile(file, &error), error);
  s.flush();
}

}  // namespace dea
