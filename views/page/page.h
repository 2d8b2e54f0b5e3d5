// views/page/page.h – the files of page/ and vendor/, as they stand in the program.
#pragma once
#include <string_view>

namespace dea::page {

std::string_view html();                                          ///< page/page.html: frame with marks like @style@
std::string_view style();                                         ///< page/style.css
std::string_view three(), plot();                                 ///< vendor/*.min.js: globals THREE, Plot
std::string_view elements(), data(), scene(), figures(), main();  ///< page/*.js, in the order they are run
std::string_view study_style();
std::string_view study_figures(), study_maps(), study_main();  ///< of a study's page, behind figures(), in this order
std::string_view build_style(), build_main();                  ///< of the page of dea build
std::string_view licences();                                   ///< vendor/LICENCES.txt

}  // namespace dea::page
