#include <febiodea/app/animate.h>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <sstream>

#include <febiodea/base/error.h>
#include <febiodea/base/numbers.h>
#include <febiodea/io/files/output.h>
#include <febiodea/views/map/gif.h>
#include <febiodea/views/map/map_paint.h>

namespace dea {

namespace {

using Show = std::function<void(MapFigure&, int frame, int frames)>;
using EachFrame = std::function<void(const Show&)>;

/// The rest of a program that is gone shall not take ours with it: writing fails instead.
struct IgnoreBrokenPipes {
  struct sigaction before = {};
  IgnoreBrokenPipes() {
    struct sigaction ignore = {};
    ignore.sa_handler = SIG_IGN;
    ::sigaction(SIGPIPE, &ignore, &before);
  }
  ~IgnoreBrokenPipes() { restore(); }
  void restore() const { ::sigaction(SIGPIPE, &before, nullptr); }
};

using File = std::unique_ptr<std::FILE, int (*)(std::FILE*)>;

/// ffmpeg, which takes pixels from a pipe and writes to an open file.
class Encoder {
 public:
  Encoder(const std::string& path, const Image& first, double fps, const Rgb& background, int file)
      : path_(path), said_(std::tmpfile(), std::fclose) {
    constexpr int kFile = 3;  // in the child
    std::vector<std::string> words = {
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
        "-threads", "1", "-map_metadata", "-1", "-fflags", "+bitexact", "-flags:v", "+bitexact", "-movflags",
        "+faststart", "-f", "mp4", fmt::format("/dev/fd/{}", kFile)};
    std::vector<char*> argv;
    for (std::string& word : words) argv.push_back(word.data());
    argv.push_back(nullptr);
    int ends[2];
    if (::pipe(ends) != 0) throw WriteError(fmt::format("{}: no pipe to ffmpeg", path_));
    const int said = said_ ? ::fileno(said_.get()) : STDERR_FILENO;
    child_ = ::fork();
    if (child_ == 0) {
      broken_pipes_.restore();
      // to numbers above those that are set, so that none is overwritten before it has been copied
      const int from = ::fcntl(ends[0], F_DUPFD, 10), to = ::fcntl(file, F_DUPFD, 10), err = ::fcntl(said, F_DUPFD, 10);
      ::dup2(from, STDIN_FILENO);
      ::dup2(err, STDOUT_FILENO);
      ::dup2(err, STDERR_FILENO);
      ::dup2(to, kFile);
      for (const int done : {from, to, err}) ::close(done);
      if (ends[1] != kFile && ends[1] > STDERR_FILENO) ::close(ends[1]);
      ::execvp(argv[0], argv.data());
      ::_exit(127);
    }
    ::close(ends[0]);
    pipe_ = ends[1];
    if (child_ < 0) {
      ::close(pipe_);
      throw WriteError(fmt::format("{}: ffmpeg cannot be started", path_));
    }
  }
  ~Encoder() {
    if (child_ <= 0) return;
    ::close(pipe_);
    ::kill(child_, SIGKILL);  // what it has written is taken away
    wait();
  }
  Encoder(const Encoder&) = delete;
  Encoder& operator=(const Encoder&) = delete;

  void add(const Image& frame) {
    for (std::size_t done = 0; done < frame.rgb.size();) {
      const ssize_t n = ::write(pipe_, frame.rgb.data() + done, frame.rgb.size() - done);
      if (n > 0) {
        done += static_cast<std::size_t>(n);
      } else if (n < 0 && errno != EINTR) {
        end();  // it has ended before its time, and says why
        throw WriteError(fmt::format("{}: ffmpeg ended before the last frame", path_));
      }
    }
  }

  void end() {
    ::close(pipe_);
    const int status = wait();
    child_ = 0;
    if (status == 0) return;
    const std::string why = last_line();
    throw WriteError(fmt::format("{}: ffmpeg failed{}", path_, why.empty() ? "" : ": " + why));
  }

 private:
  int wait() const {
    int status = 0;
    while (::waitpid(child_, &status, 0) < 0 && errno == EINTR) {
    }
    return status;
  }
  std::string last_line() const {
    if (!said_) return "";
    std::rewind(said_.get());
    std::string text;
    char part[4096];
    for (std::size_t n; (n = std::fread(part, 1, sizeof part, said_.get())) > 0;) text.append(part, n);
    std::string last;
    std::istringstream lines(text);
    for (std::string line; std::getline(lines, line);)
      if (line.find_first_not_of(" \t\r") != line.npos) last = line;
    return last;
  }

  std::string path_;
  File said_;
  IgnoreBrokenPipes broken_pipes_;
  pid_t child_ = 0;
  int pipe_ = -1;
};

bool has_ffmpeg() {
  const char* path = std::getenv("PATH");
  std::istringstream folders(path != nullptr ? path : "/usr/local/bin:/usr/bin:/bin");
  for (std::string folder; std::getline(folders, folder, ':');)
    if (::access((std::filesystem::path(folder) / "ffmpeg").c_str(), X_OK) == 0) return true;
  return false;
}

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
  const std::string lead = kFrame, end = ".png";
  if (name.size() <= lead.size() + end.size() || name.rfind(lead, 0) != 0) return false;
  if (name.compare(name.size() - end.size(), end.size(), end) != 0) return false;
  return std::all_of(name.begin() + static_cast<std::ptrdiff_t>(lead.size()),
                     name.end() - static_cast<std::ptrdiff_t>(end.size()), [](char c) { return c >= '0' && c <= '9'; });
}

void write_frames(const Animation& animation, const PictureOptions& look, const EachFrame& each) {
  using Put = std::function<void(const std::string&, const std::string&)>;
  write_folder(animation.path, is_frame, [&](const Put& put) {
    each([&](MapFigure& figure, int frame, int frames) { put(frame_name(frame, frames), picture(figure, look)); });
  });
}

}  // namespace

AnimationFormat animation_format(const std::string& path) {
  const std::string extension = extension_of(path);
  if (extension == ".gif") return AnimationFormat::Gif;
  if (extension == ".mp4") return AnimationFormat::Mp4;
  if (extension.empty() && !path.empty() && path != "-") return AnimationFormat::Folder;
  throw UsageError(
      fmt::format("--animate {}: found \"{}\", expected a name that ends in .gif or .mp4, or a folder for "
                  "a PNG of each state",
                  path, extension.empty() ? path : extension));
}

void require_encoder(const Animation& animation) {
  if (animation.format == AnimationFormat::Mp4 && !has_ffmpeg())
    throw WriteError(
        fmt::format("{}: MP4 is made by ffmpeg, which is not found; install it (Debian: ffmpeg), or give "
                    "--animate a name that ends in .gif",
                    animation.path));
}

Animated animate(const std::vector<ResultFile>& files, const ResultFile* minus, const MapOptions& options,
                 const PictureOptions& look, const Animation& animation, Progress& progress) {
  Animated done;
  const EachFrame each = [&](const Show& show) {
    done.remarks = each_map_figure(files, minus, options, [&](MapFigure& figure, int frame, int frames) {
      figure.title = animation.title;
      show(figure, frame, frames);
      done.frames = frames;
      done.panels = static_cast<int>(figure.panels.size());
      progress.step(fmt::format("frame {} of {}", frame + 1, frames), "", at(frame) + 1, at(frames));
    });
  };
  if (animation.format == AnimationFormat::Gif) write_gif(animation, look, each);
  if (animation.format == AnimationFormat::Mp4) write_mp4(animation, look, each);
  if (animation.format == AnimationFormat::Folder) write_frames(animation, look, each);
  progress.clear();
  return done;
}

}  // namespace dea
