// src/base/parse.h – values as a user writes them: the whole text must be one, in any locale.
#pragma once
#include <Eigen/Core>
#include <charconv>
#include <stdexcept>
#include <string>
#include <vector>

namespace dea {

/// A value that cannot be used. what(): `found "1,2", expected three numbers x,y,z`. Who asked adds where.
struct BadValue : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// `found "FOUND", expected EXPECTED`; of words that may be meant also the nearest one: `(did you mean "last"?)`.
BadValue bad_value(const std::string& found, const std::string& expected, const std::vector<std::string>& words = {});

/// The largest number of a model, a table or a setting: its square and cube are numbers, too.
inline constexpr double kLargestNumber = 1e30;

/// std::from_chars, which some standard libraries have for whole numbers alone.
std::from_chars_result read_number(const char* begin, const char* end, double& number);
std::from_chars_result read_number(const char* begin, const char* end, float& number);

/// 1,5 where 1.5 is meant.
bool has_decimal_comma(const std::string& text);
/// At most kLargestNumber, with a decimal point. Throws BadValue, as those below do.
double parse_number(const std::string& text);
std::vector<double> parse_numbers(const std::string& text);  ///< separated by commas
int parse_count(const std::string& text, int least, int most);
Eigen::Vector3d parse_vector(const std::string& text);  ///< three numbers separated by commas

/// "frame:pelvis,0,0,1": the frame's name, and what follows it. Without "frame:": no name, and the whole text. Throws
/// BadValue: no name, or nothing after it.
struct FramedText {
  std::string frame, rest;
};
FramedText split_frame(const std::string& text);

/// Without white space at both ends.
std::string trimmed(const std::string& text);
/// Capitals (of ASCII) as small letters.
std::string lower_case(std::string text);
/// The words between separators, as they stand; one more than there are separators.
std::vector<std::string> split(const std::string& text, char separator);
/// "a, b,c" as "a", "b", "c".
std::vector<std::string> split_at_commas(const std::string& text);

}  // namespace dea
