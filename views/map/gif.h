// views/map/gif.h – pictures that move, as GIF: frame by frame, in colours that are those of the map.
#pragma once
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "views/map/colour_map.h"
#include "views/map/picture_format.h"

namespace dea {

/// 256 colours for all frames: the map's steps as they are drawn, those of the paper, lines over the map, and the greys
/// between paper and letters.
std::vector<ByteColour> gif_palette(ColourMap map, bool dark);

/// Writes as it goes: memory does not grow with the frames. A pixel whose colour is in the palette keeps it, any other
/// gets the nearest (in OKLab); nothing is dithered. Plays again and again.
class GifWriter {
 public:
  using Put = std::function<void(const std::string& bytes)>;
  /// Frames for 1 / `fps` seconds each, to the hundredth of a second that GIF knows: later ones make up for it.
  GifWriter(Put put, std::vector<ByteColour> palette, double fps);
  ~GifWriter();
  GifWriter(const GifWriter&) = delete;
  GifWriter& operator=(const GifWriter&) = delete;

  /// All frames have the size of the first.
  void add(const Image& frame);
  /// After the last frame.
  void end();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace dea
