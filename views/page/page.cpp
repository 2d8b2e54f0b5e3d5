// The files are taken in by the assembler; CMake says where they are and builds this again when one changes.
#include "views/page/page.h"

#define DEA_EMBED(name, file)                                                                                    \
  __asm__(                                                                                                       \
      ".pushsection .rodata\n"                                                                                   \
      ".global dea_page_" #name                                                                                  \
      "_begin\n"                                                                                                 \
      ".hidden dea_page_" #name                                                                                  \
      "_begin\n"                                                                                                 \
      "dea_page_" #name                                                                                          \
      "_begin:\n"                                                                                                \
      ".incbin \"" DEA_PAGE_DIR "/" file                                                                         \
      "\"\n"                                                                                                     \
      ".global dea_page_" #name                                                                                  \
      "_end\n"                                                                                                   \
      ".hidden dea_page_" #name                                                                                  \
      "_end\n"                                                                                                   \
      "dea_page_" #name                                                                                          \
      "_end:\n"                                                                                                  \
      ".byte 0\n"                                                                                                \
      ".popsection\n");                                                                                          \
  extern "C" const char dea_page_##name##_begin[];                                                               \
  extern "C" const char dea_page_##name##_end[];                                                                 \
  namespace dea::page {                                                                                          \
  std::string_view name() {                                                                                      \
    return {dea_page_##name##_begin, static_cast<std::size_t>(dea_page_##name##_end - dea_page_##name##_begin)}; \
  }                                                                                                              \
  }

DEA_EMBED(html, "html/page.html")
DEA_EMBED(style, "html/style.css")
DEA_EMBED(three, "vendor/three.min.js")
DEA_EMBED(plot, "vendor/plot.min.js")
DEA_EMBED(data, "html/data.js")
DEA_EMBED(scene, "html/scene.js")
DEA_EMBED(figures, "html/figures.js")
DEA_EMBED(main, "html/page.js")
DEA_EMBED(study_style, "html/study.css")
DEA_EMBED(study_figures, "html/study_figures.js")
DEA_EMBED(study_maps, "html/study_maps.js")
DEA_EMBED(study_main, "html/study.js")
DEA_EMBED(build_style, "html/build.css")
DEA_EMBED(build_main, "html/build.js")
DEA_EMBED(licences, "vendor/LICENCES.txt")
