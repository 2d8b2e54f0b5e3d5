// A plot file: read in full and in outline; what was read can be written and read again.
#include <febiodea/io/xplt/xplt.h>
#include "fuzz.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string path = dea::fuzz::file_of(data, size, ".xplt");
  dea::fuzz::answer_or_refusal([&] { dea::read_xplt_outline(path); });
  dea::fuzz::answer_or_refusal([&] {
    const dea::XpltFile file = dea::read_xplt(path);
    const std::string again = path + ".again.xplt";
    dea::write_xplt(again, file);
    dea::read_xplt(again);
  });
  return 0;
}
