// A model: read, and recognised as far as it goes.
#include <febiodea/io/feb/read_feb.h>
#include <febiodea/run/recognise.h>
#include "fuzz.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  dea::fuzz::answer_or_refusal([&] { dea::recognise(dea::read_feb(dea::fuzz::file_of(data, size, ".feb"))); });
  return 0;
}
