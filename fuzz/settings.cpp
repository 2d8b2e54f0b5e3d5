// A settings file.
#include <febiodea/io/settings/settings_xml.h>
#include "fuzz.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  dea::fuzz::answer_or_refusal([&] { dea::read_settings_file(dea::fuzz::file_of(data, size, ".xml")); });
  return 0;
}
