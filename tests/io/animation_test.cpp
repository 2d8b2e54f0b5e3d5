// Maps of all states one after the other: one scale and size, the map's colours in a GIF, files complete or not there.
#include <fmt/format.h>
#include <gif_lib.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <functional>
#include <map>
#include <set>

#include "io/files/output.h"
#include "src/base/error.h"
#include "src/base/numbers.h"
#include "tests/io/plot_files.h"
#include "tests/program.h"
#include "views/map/draw_map.h"
#include "views/map/gif.h"
#include "views/map/map_figure.h"

namespace dea::animation_test {

namespace fs = std::filesystem;
using test::cap;
using test::file_text;
using test::Finished;
using test::PlotPatch;
using test::result_of;
using test::run_program;
using test::sheet;
using test::TemporaryFolder;

struct GifFrame {
  int left = 0, top = 0, width = 0, height = 0, hundredths = 0;
};

struct Gif {
  int width = 0, height = 0;
  bool again = false;
  std::vector<ByteColour> palette;
  std::vector<GifFrame> parts;
  std::vector<Image> frames;  ///< as they are seen
};

/// What any reader of GIF sees, by giflib's own decoder.
Gif decoded(const std::string& bytes) {
  struct Source {
    const std::string* bytes;
    std::size_t done;
  } source = {&bytes, 0};
  const auto read = [](GifFileType* file, GifByteType* to, int n) {
    Source& s = *static_cast<Source*>(file->UserData);
    const std::size_t take = std::min<std::size_t>(static_cast<std::size_t>(n), s.bytes->size() - s.done);
    std::memcpy(to, s.bytes->data() + s.done, take);
    s.done += take;
    return static_cast<int>(take);
  };
  int error = 0;
  GifFileType* file = DGifOpen(&source, read, &error);
  Gif gif;
  if (file == nullptr || DGifSlurp(file) != GIF_OK) {
    ADD_FAILURE() << "no GIF";
    return gif;
  }
  gif.width = file->SWidth;
  gif.height = file->SHeight;
  for (int i = 0; i < file->SColorMap->ColorCount; ++i) {
    const GifColorType& c = file->SColorMap->Colors[i];
    gif.palette.push_back({c.Red, c.Green, c.Blue});
  }
  Image seen = {gif.width, gif.height, std::vector<std::uint8_t>(at(3 * gif.width * gif.height))};
  for (int k = 0; k < file->ImageCount; ++k) {
    const SavedImage& part = file->SavedImages[k];
    const GifImageDesc& d = part.ImageDesc;
    GraphicsControlBlock control = {};
    EXPECT_EQ(DGifSavedExtensionToGCB(file, k, &control), GIF_OK);
    gif.parts.push_back({d.Left, d.Top, d.Width, d.Height, control.DelayTime});
    for (int y = 0; y < d.Height; ++y)
      for (int x = 0; x < d.Width; ++x) {
        const ByteColour& c = gif.palette[part.RasterBits[y * d.Width + x]];
        std::copy(c.begin(), c.end(), seen.rgb.begin() + 3 * ((d.Top + y) * gif.width + d.Left + x));
      }
    gif.frames.push_back(seen);
  }
  gif.again = bytes.find("NETSCAPE2.0") != std::string::npos;
  DGifCloseFile(file, &error);
  return gif;
}

ByteColour byte_colour(const Rgb& c) {
  const auto byte = [](double x) { return static_cast<std::uint8_t>(std::lround(255 * x)); };
  return {byte(c.r), byte(c.g), byte(c.b)};
}

/// A 4 x 2 sheet whose pressure grows to 8 in the last of four states; none in the first.
ResultFile growing(const std::string& label = "a", double most = 8) {
  std::vector<std::vector<double>> states;
  for (int s = 0; s < 4; ++s) {
    std::vector<double> values;
    for (int f = 0; f < 8; ++f) values.push_back(most * s / 3.0 * (f + 1) / 8.0);
    states.push_back(values);
  }
  return result_of(label, sheet(4, 2, 4, 2), states);
}

TEST(Animation, FramesHaveOneScaleViewLegendAndSize) {
  MapOptions o;
  o.states = "all";
  o.up = {0, 1, 0};
  const ResultFile a = growing(), b = growing("b", 6);
  std::vector<std::string> titles, numbers;
  std::set<std::pair<int, int>> sizes;
  int frames = 0;
  each_map_figure({a, b}, nullptr, o, [&](MapFigure& f, int frame, int count) {
    EXPECT_EQ(frame, frames++);
    EXPECT_EQ(count, 4);
    EXPECT_EQ(f.low, 0);
    EXPECT_EQ(f.high, 8);
    EXPECT_EQ(f.surfaces.size(), 2u);
    ASSERT_EQ(f.panels.size(), 2u);
    EXPECT_FALSE(f.empty);  // the first frame has no pressure, and the same colour bar
    EXPECT_TRUE(f.signs.peak && f.signs.center_of_pressure && f.signs.nothing);
    titles.push_back(f.panels[1].title);
    numbers.push_back(f.panels[0].numbers.front());
    const Image image = map_image(f, {PictureFormat::Png, 0, 60, false});
    sizes.insert({image.width, image.height});
  });
  EXPECT_EQ(titles, (std::vector<std::string>{"b, time 0", "b, time 1", "b, time 2", "b, time 3"}));
  EXPECT_EQ(numbers[0], "no contact");
  EXPECT_EQ(sizes.size(), 1u);

  // A frame shows what a picture of its state shows.
  MapOptions one = o;
  one.states = "2";
  const MapFigure still = make_map_figure({a, b}, nullptr, one);
  each_map_figure({a, b}, nullptr, o, [&](MapFigure& f, int frame, int) {
    if (frame != 2) return;
    for (std::size_t k = 0; k < 2; ++k) {
      EXPECT_EQ(f.panels[k].facets, still.panels[k].facets);
      EXPECT_EQ(f.panels[k].numbers, still.panels[k].numbers);
      EXPECT_EQ(f.panels[k].peak, still.panels[k].peak);
      EXPECT_EQ(f.panels[k].center_of_pressure, still.panels[k].center_of_pressure);
    }
  });

  // Differences, and a single state, have their time too.
  each_map_figure({a}, &b, o, [&](MapFigure& f, int frame, int) {
    ASSERT_EQ(f.panels.size(), 1u);
    EXPECT_EQ(f.map, ColourMap::Diverging);
    EXPECT_EQ(f.high, 2);
    EXPECT_EQ(f.panels[0].title, fmt::format("a \u2212 b, time {}", frame));
  });
  o.states = "3";
  each_map_figure({a}, nullptr, o, [&](MapFigure& f, int, int) { EXPECT_EQ(f.panels[0].title, "surface, time 3"); });
}

TEST(Gif, ThePaletteHoldsTheMapAndThePaper) {
  for (ColourMap map :
       {ColourMap::Sequential, ColourMap::Diverging, ColourMap::Viridis, ColourMap::Cividis, ColourMap::Gray})
    for (bool dark : {false, true}) {
      const std::vector<ByteColour> palette = gif_palette(map, dark);
      ASSERT_EQ(palette.size(), 256u);
      const auto holds = [&](const Rgb& c) {
        return std::find(palette.begin(), palette.end(), byte_colour(c)) != palette.end();
      };
      for (int b = 0; b < kBands; ++b) EXPECT_TRUE(holds(band_colour(map, b))) << b;
      const Paper p = paper(dark, map);
      for (const Rgb& c : {p.background, p.text, p.faint, p.line, p.nothing, p.turned_away}) EXPECT_TRUE(holds(c));
    }
}

TEST(Gif, ColoursOfTheMapAreTheirOwnInEveryFrame) {
  MapOptions o;
  o.states = "all";
  const PictureOptions look = {PictureFormat::Png, 80, 96, false};
  std::string bytes, again;
  std::vector<Image> drawn;
  for (std::string* to : {&bytes, &again}) {
    drawn.clear();
    GifWriter gif([&](const std::string& piece) { *to += piece; }, gif_palette(ColourMap::Sequential, false), 12);
    each_map_figure({growing()}, nullptr, o, [&](MapFigure& f, int, int) {
      drawn.push_back(map_image(f, look));
      gif.add(drawn.back());
    });
    gif.add(drawn.back());  // stands still
    gif.end();
  }
  drawn.push_back(drawn.back());
  EXPECT_TRUE(bytes == again);
  const Gif gif = decoded(bytes);
  EXPECT_TRUE(gif.again);
  ASSERT_EQ(gif.frames.size(), 5u);
  EXPECT_EQ(gif.palette, gif_palette(ColourMap::Sequential, false));
  std::set<ByteColour> bands;
  for (int b = 0; b < kBands; ++b) bands.insert(byte_colour(band_colour(ColourMap::Sequential, b)));
  const std::set<ByteColour> known(gif.palette.begin(), gif.palette.end());
  long of_map = 0, same = 0, of_palette = 0, pixels = 0;
  double farthest = 0.0;
  for (std::size_t k = 0; k < 5; ++k) {
    ASSERT_EQ(gif.frames[k].rgb.size(), drawn[k].rgb.size());
    for (std::size_t i = 0; i < drawn[k].rgb.size(); i += 3) {
      const std::uint8_t *x = &drawn[k].rgb[i], *y = &gif.frames[k].rgb[i];
      const bool equal = std::equal(x, x + 3, y);
      ++pixels;
      if (known.count({x[0], x[1], x[2]}) > 0) {
        ++of_palette;
        same += equal;
        of_map += bands.count({x[0], x[1], x[2]}) > 0;
      }
      for (int c = 0; c < 3; ++c) farthest = std::max(farthest, std::abs(double(x[c]) - y[c]));
    }
  }
  EXPECT_GT(of_map, 10000);                                  // there is something to compare
  EXPECT_EQ(same, of_palette);                               // each of them
  EXPECT_GT(of_palette, 0.8 * static_cast<double>(pixels));  // the others are edges of letters and lines
  EXPECT_LT(farthest, 128);                                  // between edges no black becomes white
  // Twelfths of a second in hundredths: the sums are right to half of one.
  int sum = 0;
  for (std::size_t k = 0; k < 5; ++k) {
    sum += gif.parts[k].hundredths;
    EXPECT_NEAR(sum, 100.0 * static_cast<double>(k + 1) / 12, 0.5 + 1e-9);
  }
  // Only what changes is written again; where nothing does, one pixel.
  EXPECT_EQ(gif.parts[0].width, gif.width);
  EXPECT_LT(gif.parts[2].width, gif.width);
  EXPECT_EQ(gif.parts[4].width * gif.parts[4].height, 1);
}

/// A folder with plot files, and the program.
struct AnimationFolder : ::testing::Test {
  TemporaryFolder folder;
  void SetUp() override {
    write_xplt((folder.path / "a.xplt").string(), growing().xplt);
    write_xplt((folder.path / "b.xplt").string(), growing("b", 6).xplt);
    fs::create_directory(folder.path / "bin");
    fs::create_directory(folder.path / "mine");
    std::ofstream(folder.path / "mine" / "notes.txt") << "mine";
  }
  Finished plot(std::vector<std::string> words, const std::string& path = "/usr/bin:/bin") {
    const std::vector<std::string> lead = {"/usr/bin/env", "PATH=" + path, DEA_PROGRAM, "plot"};
    words.insert(words.begin(), lead.begin(), lead.end());
    return run_program(folder.path, words, 30);
  }
  /// An ffmpeg that does what a script says.
  std::string ffmpeg(const std::string& script) const {
    const fs::path program = folder.path / "bin" / "ffmpeg";
    std::ofstream(program) << "#!/bin/sh\n" << script;
    fs::permissions(program, fs::perms::owner_all);
    return (folder.path / "bin").string() + ":/usr/bin:/bin";
  }
  std::vector<std::string> names(const fs::path& where) const {
    std::vector<std::string> out;
    for (const auto& entry : fs::directory_iterator(where)) out.push_back(entry.path().filename().string());
    std::sort(out.begin(), out.end());
    return out;
  }
};

TEST_F(AnimationFolder, WritesAGif) {
  const Finished f =
      plot({"a.xplt", "b.xplt", "--animate", "walk.gif", "--fps", "4", "--dpi", "60", "--title", "Walk"});
  EXPECT_EQ(f.code, 0) << f.err;
  EXPECT_EQ(f.err, "walk.gif: 4 frames, 2 panels each\n");
  const Gif gif = decoded(file_text(folder.path / "walk.gif"));
  ASSERT_EQ(gif.frames.size(), 4u);
  for (const GifFrame& part : gif.parts) EXPECT_EQ(part.hundredths, 25);
  // The pixels are those of a picture of that state with that scale.
  EXPECT_EQ(plot({"a.xplt", "--at", "1,3", "--animate", "two.GIF", "-q"}).code, 0);
  EXPECT_EQ(decoded(file_text(folder.path / "two.GIF")).frames.size(), 2u);
  EXPECT_EQ(plot({"a.xplt", "--minus", "b.xplt", "--animate", "minus.gif", "--dark", "--smooth"}).code, 0);
  EXPECT_EQ(decoded(file_text(folder.path / "minus.gif")).frames.size(), 4u);
}

TEST_F(AnimationFolder, WritesPicturesIntoAFolder) {
  ASSERT_EQ(plot({"a.xplt", "--animate", "frames/", "--dpi", "50"}).code, 0);
  EXPECT_EQ(names(folder.path / "frames"),
            (std::vector<std::string>{"frame-0001.png", "frame-0002.png", "frame-0003.png", "frame-0004.png"}));
  const std::string first = file_text(folder.path / "frames" / "frame-0001.png");
  EXPECT_EQ(first.substr(1, 3), "PNG");
  // Again, with fewer: none of the earlier ones stays.
  ASSERT_EQ(plot({"a.xplt", "--animate", "frames", "--dpi", "50", "--at", "0,2"}).code, 0);
  EXPECT_EQ(names(folder.path / "frames"), (std::vector<std::string>{"frame-0001.png", "frame-0002.png"}));
  EXPECT_NE(file_text(folder.path / "frames" / "frame-0001.png"), "");
  const Finished refused = plot({"a.xplt", "--animate", "mine"});
  EXPECT_EQ(refused.code, 4);
  EXPECT_NE(refused.err.find("mine: holds notes.txt"), std::string::npos) << refused.err;
  EXPECT_EQ(names(folder.path / "mine"), std::vector<std::string>{"notes.txt"});
  EXPECT_EQ(names(folder.path), (std::vector<std::string>{"a.xplt", "b.xplt", "bin", "frames", "mine"}));
}

TEST_F(AnimationFolder, GivesFramesToFfmpeg) {
  // Stands for ffmpeg: notes its words and how many bytes it gets, writes to the file it is given.
  const std::string path =
      ffmpeg("printf '%s\\n' \"$@\" > words\nwc -c > bytes\nfor last; do :; done\necho film > $last\n");
  const Finished f = plot({"a.xplt", "--animate", "walk.mp4", "--fps", "5", "--dpi", "60"}, path);
  EXPECT_EQ(f.code, 0) << f.err;
  EXPECT_EQ(file_text(folder.path / "walk.mp4"), "film\n");
  const std::string words = file_text(folder.path / "words");
  EXPECT_NE(words.find("-framerate\n5.000000\n"), std::string::npos) << words;
  int width = 0, height = 0;
  ASSERT_EQ(std::sscanf(words.c_str() + words.find("-video_size\n"), "-video_size\n%dx%d", &width, &height), 2);
  EXPECT_EQ(std::stol(file_text(folder.path / "bytes")), 4L * 3 * width * height);
}

TEST_F(AnimationFolder, SaysWhenFfmpegIsMissingOrFails) {
  const std::vector<std::string> before = names(folder.path);
  const std::vector<std::string> words = {"a.xplt", "--animate", "walk.mp4", "--dpi", "60"};
  const Finished missing = plot(words, (folder.path / "mine").string());
  EXPECT_EQ(missing.code, 4);
  EXPECT_NE(missing.err.find("MP4 is made by ffmpeg, which is not found"), std::string::npos) << missing.err;
  // One that ends at once, while frames are on their way; and one that ends after them.
  for (const char* script :
       {"echo no room >&2\nexit 1\n", "cat > /dev/null\necho line >&2\necho no room >&2\nexit 1\n"}) {
    const Finished f = plot(words, ffmpeg(script));
    EXPECT_EQ(f.code, 4);
    EXPECT_NE(f.err.find("walk.mp4: ffmpeg failed: no room"), std::string::npos) << f.err;
    EXPECT_EQ(std::count(f.err.begin(), f.err.end(), '\n'), 1) << f.err;
  }
  const Finished content = plot(words, ffmpeg("exit 0\n"));  // while frames are on their way
  EXPECT_EQ(content.code, 4);
  EXPECT_EQ(content.err, "dea: cannot write walk.mp4: ffmpeg ended before the last frame\n");
  EXPECT_EQ(names(folder.path), before);
  fs::create_symlink("/dev/null", folder.path / "null.mp4");
  const Finished device = plot({"a.xplt", "--animate", "null.mp4", "--dpi", "60"}, ffmpeg("cat > /dev/null\n"));
  EXPECT_EQ(device.code, 4);
  EXPECT_EQ(device.err, "dea: cannot write null.mp4: is no file, expected one or a new name\n");
}

TEST_F(AnimationFolder, RefusesInOneLine) {
  struct Case {
    std::vector<std::string> words;
    int code;
    std::string said;
  };
  const std::vector<Case> cases = {
      {{"a.xplt", "-o", "walk.gif"}, 2, "is an animation's name, expected --animate walk.gif"},
      {{"a.xplt", "-o", "walk.png", "--animate", "walk.gif"}, 2, "-o and --animate: found both"},
      {{"a.xplt", "--fps", "3"}, 2, "--fps 3: belongs to --animate"},
      {{"a.xplt", "--animate", "walk.gif", "--fps", "0"}, 2, "expected a number from 0.1 to 50"},
      {{"a.xplt", "--animate", "frames", "--fps", "3"}, 2, "pictures in a folder have no time"},
      {{"a.xplt", "--animate", "walk.avi"},
       2,
       "found \".avi\", expected a name that ends in .gif or .mp4, or a folder"},
      {{"a.xplt", "--animate", "-"}, 2, "--animate -"},
      {{"a.xplt", "--animate", "a.xplt"}, 2, "--animate a.xplt"},
      {{"a.xplt", "--animate", "nowhere/walk.gif"}, 4, "there is no folder nowhere"},
      {{"a.xplt", "--animate", "nowhere/frames"}, 4, "there is no folder nowhere"},
      {{"a.xplt", "--animate", "walk.gif", "--at", "7"}, 3, "found no state at time 7"},
  };
  const std::vector<std::string> before = names(folder.path);
  for (const Case& c : cases) {
    const Finished f = plot(c.words);
    EXPECT_EQ(f.code, c.code) << f.err;
    EXPECT_NE(f.err.find(c.said), std::string::npos) << c.said << "\n" << f.err;
    EXPECT_EQ(std::count(f.err.begin(), f.err.end(), '\n'), 1) << f.err;
  }
  EXPECT_EQ(names(folder.path), before);
  fs::create_symlink("/dev/full", folder.path / "full.gif");
  const Finished full = plot({"a.xplt", "--animate", "full.gif"});
  EXPECT_EQ(full.code, 4);
  EXPECT_NE(full.err.find("No space left"), std::string::npos) << full.err;
}

TEST_F(AnimationFolder, LeavesNothingWhenStopped) {
  // Many states, so that it is at work when it is stopped.
  ResultFile many = growing();
  for (int i = 4; i < 400; ++i) {
    many.xplt.states.push_back(many.xplt.states[at(i % 4)]);
    many.xplt.states.back().time = static_cast<float>(i);
  }
  write_xplt((folder.path / "many.xplt").string(), many.xplt);
  const std::vector<std::string> before = names(folder.path);
  for (const char* output : {"walk.gif", "frames"}) {
    // stops it as soon as it has begun to write
    const std::string script = fmt::format(
        "{} plot many.xplt --animate {} -q & p=$!\nwhile kill -0 $p && ! ls -A | grep -q '^[.].*tmp$'; do sleep 0.01; "
        "done\n"
        "sleep 0.3\nkill -TERM $p\nwait $p\necho $?\n",
        DEA_PROGRAM, output);
    const Finished f = run_program(folder.path, {"/bin/sh", "-c", script}, 60);
    EXPECT_EQ(f.out, "143\n") << f.err;
    EXPECT_EQ(names(folder.path), before);
  }
}

}  // namespace dea::animation_test
