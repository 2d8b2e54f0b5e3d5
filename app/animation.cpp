#include "app/animation.h"

#include <fmt/format.h>

#include <functional>
#include <memory>
#include <optional>
#include <sstream>
#include <string_view>

#include "app/process.h"
#include "app/progress.h"
#include "io/files/output.h"
#include "io/files/system.h"
#include "io/results/existing_file.h"
#include "src/base/error.h"
#include "src/base/numbers.h"
#include "views/map/gif.h"
#include "views/map/map_figure.h"

namespace dea {

namespace {

using Show = std::function<void(MapFigure&, int frame, int frames)>;
using EachFrame = std::function<void(const Show&)>;

/// ffmpeg, which takes pixels from a pipe and writes to an open file.
class Encoder {
 public:
  Encoder(const std::string& path, const Image& first, double fps, const Rgb& background, int file)
      : path_(path), said_(open_nameless()) {
    const std::vector<std::string> words = {
        "ffmpeg", "-hide_banner", "-nostats", "-loglevel", "error", "-y", "-f", "rawvideo", "-pixel_format", "rgb24",
        "-video_size", fmt::format("{}x{}", first.width, first.height), "-framerate", fmt::format("{:.6f}", fps), "-i",
        "pipe:0",
        // H.264 in 4:2:0, which every player takes, has even sizes
        "-vf",
        fmt::format("pad=ceil(iw/2)*2:ceil(ih/2)*2:color=0x{},scale=out_color_matrix=bt709:out_range=tv:flags="
                    "accurate_rnd+full_chroma_int+bitexact",
                    hex(background).substr(1)),
        "-c:v", "libx264", "-preset", "medium", "-crf", "12", "-pix_fmt", "yuv420p", "-colorspace", "bt709",
        "-color_primaries", "bt709", "-color_trc", "bt709",
        // the same bytes every time, on machines with however many cores
        "-threads", "1", "-map_metadata", "-1", "-metadata", fmt::format("comment={}", kPictureMark), "-fflags",
        "+bitexact", "-flags:v", "+bitexact", "-movflags", "+faststart", "-f", "mp4", "/dev/fd/3"};
    int frames = -1;
    if (!open_pipe(frames, pipe_)) throw WriteError(fmt::format("{}: no pipe to ffmpeg", path_));
    const int said = said_ < 0 ? kStandardError : said_;
    child_ = start_program(words, {frames, said, said, file});
    close_file(frames);
    if (child_ < 0) {
      close_file(pipe_);
      throw WriteError(fmt::format("{}: ffmpeg cannot be started", path_));
    }
  }
  ~Encoder() {
    close_file(said_);
    if (child_ <= 0) return;
    close_file(pipe_);
    kill_program(child_);  // what it has written is taken away
    wait_for(child_);
  }
  Encoder(const Encoder&) = delete;
  Encoder& operator=(const Encoder&) = delete;

  void add(const Image& frame) {
    const std::string_view pixels(reinterpret_cast<const char*>(frame.rgb.data()), frame.rgb.size());
    if (write_all(pipe_, pixels) == 0) return;
    end();  // it has ended before its time, and says why
    throw WriteError(fmt::format("{}: ffmpeg ended before the last frame", path_));
  }

  void end() {
    close_file(pipe_);
    const int code = wait_for(child_);
    child_ = 0;
    if (code == 0) return;
    const std::string why = last_line();
    throw WriteError(fmt::format("{}: ffmpeg failed{}", path_, why.empty() ? "" : ": " + why));
  }

 private:
  std::string last_line() const {
    std::string text, part;
    do text += part = read_at(said_, text.size(), 4096);
    while (!part.empty());
    std::string last;
    std::istringstream lines(text);
    for (std::string line; std::getline(lines, line);)
      if (line.find_first_not_of(" \t\r") != line.npos) last = line;
    return last;
  }

  std::string path_;
  int said_;
  const std::shared_ptr<void> broken_pipe_ = ignore_broken_pipe();
  int child_ = 0;
  int pipe_ = -1;
};

void write_gif(const Animation& animation, const PictureOptions& look, const EachFrame& each) {
  write_pieces(animation.path, [&](const std::function<void(const std::string&)>& put) {
    std::optional<GifWriter> gif;
    each([&](MapFigure& figure, int, int) {
      if (!gif) gif.emplace(put, gif_palette(figure.map, look.dark), animation.fps);
      gif->add(map_image(figure, look));
    });
    gif->end();
  });
}

void write_mp4(const Animation& animation, const PictureOptions& look, const EachFrame& each) {
  write_open_file(animation.path, [&](int file) {
    std::optional<Encoder> encoder;
    each([&](MapFigure& figure, int, int) {
      const Image image = map_image(figure, look);
      if (!encoder)
        encoder.emplace(animation.path, image, animation.fps, paper(look.dark, figure.map).background, file);
      encoder->add(image);
    });
    encoder->end();
  });
}

constexpr const char* kFrame = "frame-";

/// "frame-0012.png": in order by name too, so with as many digits as the last needs.
std::string frame_name(int frame, int frames) {
  return fmt::format("{}{:0{}}.png", kFrame, frame + 1, std::max<std::size_t>(4, fmt::formatted_size("{}", frames)));
}

bool is_frame(const std::string& name) {
  const std::string_view lead = kFrame, end = ".png";
  if (name.size() <= lead.size() + end.size() || !name.starts_with(lead) || !name.ends_with(end)) return false;
  return name.find_first_not_of("0123456789", lead.size()) == name.size() - end.size();
}

void write_frames(const Animation& animation, const PictureOptions& look, const EachFrame& each) {
  write_folder(animation.path, is_frame, [&](const PutFile& put) {
    each([&](MapFigure& figure, int frame, int frames) { put(frame_name(frame, frames), picture(figure, look)); });
  });
}

/// By the name: .gif, .mp4, or without an ending (or ending in /) a folder.
Animation::Format format_of(const std::string& path) {
  const std::string extension = extension_of(path);
  if (extension == ".gif") return Animation::Format::Gif;
  if (extension == ".mp4") return Animation::Format::Mp4;
  if (extension.empty() && !path.empty() && path != "-") return Animation::Format::Folder;
  throw UsageError(
      fmt::format("--animate {}: found \"{}\", expected a name that ends in .gif or .mp4, or a folder for "
                  "a PNG of each state",
                  path, extension.empty() ? path : extension));
}

void require_encoder(const Animation& animation) {
  if (animation.format == Animation::Format::Mp4 && !on_path("ffmpeg"))
    throw WriteError(
        fmt::format("{}: MP4 is made by ffmpeg, which is not found; install it (Debian: ffmpeg), or give "
                    "--animate a name that ends in .gif",
                    animation.path));
}

}  // namespace

Animation animation_asked(const std::string& path) {
  Animation animation;
  animation.path = path;
  animation.format = format_of(path);
  require_encoder(animation);
  return animation;
}

Drawn animate(const std::vector<ResultFile>& files, const ResultFile* minus, const MapOptions& options,
              const PictureOptions& look, const std::string& title, const Animation& animation, bool quiet) {
  Progress progress(progress_style(quiet, false));
  Drawn done;
  const EachFrame each = [&](const Show& show) {
    done.remarks = each_map_figure(files, minus, options, [&](MapFigure& figure, int frame, int frames) {
      figure.title = title;
      done.solved = done.solved && all_solved(figure);
      show(figure, frame, frames);
      const std::size_t panels = figure.panels.size();
      done.what =
          fmt::format("{} frame{}, {} panel{} each", frames, frames == 1 ? "" : "s", panels, panels == 1 ? "" : "s");
      progress.step(fmt::format("frame {} of {}", frame + 1, frames), "", at(frame) + 1, at(frames));
    });
  };
  if (animation.format == Animation::Format::Gif) write_gif(animation, look, each);
  if (animation.format == Animation::Format::Mp4) write_mp4(animation, look, each);
  if (animation.format == Animation::Format::Folder) write_frames(animation, look, each);
  return done;
}

}  // namespace dea
