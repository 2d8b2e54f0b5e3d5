// app/animation.h – maps of all states one after the other, for `dea plot --animate`. Without Cairo there are none
// (no_animation.cpp).
#pragma once
#include <string>
#include <vector>

#include "io/results/result_file.h"
#include "views/map/draw_map.h"

namespace dea {

struct Animation {
  enum class Format { Gif, Mp4, Folder } format = Format::Gif;
  std::string path;
  double fps = 12.0;  ///< frames per second; a folder has none
};
/// By the name: .gif, .mp4, or without an ending (or ending in /) a folder. Throws where it cannot be made.
Animation animation_asked(const std::string& path);

/// What is written, or was: its size in words.
struct Drawn {
  std::string what;
  std::vector<std::string> remarks;
  bool solved = true;  ///< is every state shown a solution?
};

/// Draws and writes frame by frame; what is written is complete or not there.
Drawn animate(const std::vector<ResultFile>& files, const ResultFile* minus, const MapOptions& options,
              const PictureOptions& look, const std::string& title, const Animation& animation, bool quiet);

}  // namespace dea
