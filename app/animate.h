// app/animate.h – maps of all states one after the other: GIF, MP4, or a folder of PNG.
#pragma once
#include <string>
#include <vector>

#include "app/progress.h"
#include "views/map/draw_map.h"

namespace dea {

enum class AnimationFormat { Gif, Mp4, Folder };

/// By the name: .gif, .mp4, or without an ending (or ending in /) a folder. Throws UsageError in the name of --animate.
AnimationFormat animation_format(const std::string& path);

struct Animation {
  AnimationFormat format = AnimationFormat::Gif;
  std::string path;
  double fps = 12.0;  ///< frames per second; a folder has none
  std::string title;
};

struct Animated {
  int frames = 0, panels = 0;  ///< panels of each frame
  bool solved = true;          ///< is every state shown a solution?
  std::vector<std::string> remarks;
};

/// Draws and writes frame by frame; what is written is complete or not there. Throws WriteError: cannot be written, no
/// ffmpeg for MP4; and what each_map_figure throws.
Animated animate(const std::vector<ResultFile>& files, const ResultFile* minus, const MapOptions& options,
                 const PictureOptions& look, const Animation& animation, Progress& progress);

/// Throws WriteError if MP4 is asked for and there is no ffmpeg.
void require_encoder(const Animation& animation);

}  // namespace dea
