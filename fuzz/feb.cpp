// A model: read, recognised as far as it goes, and converted.
#include "fuzz/fuzz.h"
#include "io/convert/convert_feb.h"
#include "io/feb/read_feb.h"
#include "src/run/recognise.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  dea::fuzz::answer_or_refusal([&] {
    const std::string path = dea::fuzz::file_of(data, size, ".feb");
    const dea::JointModel model = dea::read_feb(path);
    dea::recognise(model);
    dea::convert_feb(model, {}, path + ".out.feb");
  });
  return 0;
}
