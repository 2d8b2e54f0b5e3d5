// A settings file.
#include "fuzz/fuzz.h"
#include "io/settings/settings_xml.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  dea::fuzz::answer_or_refusal([&] { dea::read_settings_file(dea::fuzz::file_of(data, size, ".xml")); });
  return 0;
}
