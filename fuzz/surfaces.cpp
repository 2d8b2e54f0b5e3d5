// A surface of a bone. The first byte chooses the format.
#include "fuzz/fuzz.h"
#include "io/surfaces/read_surface.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  static const char* endings[] = {".stl", ".obj", ".ply", ".vtk", ".vtp"};
  const std::string path = dea::fuzz::file_of(data + 1, size - 1, endings[data[0] % 5]);
  dea::fuzz::answer_or_refusal([&] { dea::read_surface(path); });
  return 0;
}
