// Text files of numbers: one record a line, numbers separated by spaces or tabs (calibration, times, poses).
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace penumbra::nn {

struct NumberLine {
  int line = 0;                // 1-based line in the file, for messages
  std::vector<double> values;  // all finite
};

// The numbers of one line of text. Throws InputError naming `place` and the word that is not a finite number.
std::vector<double> parse_numbers(std::string_view text, std::string_view place);

// Reads a text file (nn::read_text_file) line by line. Empty lines and lines that start with '#' are skipped;
// blanks at both ends of a line are left out.
class LineReader {
 public:
  // Throws InputError where the file cannot be read; `expected` says what it should be.
  LineReader(const std::filesystem::path& path, std::string_view expected);
  // The next line, none at the end; it lives as long as the reader.
  std::optional<std::string_view> next();
  // Number and "file:line" of the last line.
  int line() const { return line_; }
  std::string place() const;

 private:
  std::string path_, text_;
  std::size_t start_ = 0;  // of the next line in text_
  int line_ = 0;
};

// Reads a file record by record. Empty lines and lines that start with '#' are skipped; Windows line ends are
// taken. The file is held in memory.
class NumberFileReader {
 public:
  // Throws InputError where the file cannot be read; `record` says what a line should be, such as
  // "a time in seconds".
  NumberFileReader(const std::filesystem::path& path, std::string_view record);
  // The next record, none at the end. Throws InputError (file:line) for a word that is no finite number.
  std::optional<NumberLine> next();
  // "file:line" of the last record.
  std::string place() const { return lines_.place(); }

 private:
  LineReader lines_;
};

// All records of a file, each of exactly `columns` numbers; throws InputError (file:line) for another count.
std::vector<NumberLine> read_number_file(const std::filesystem::path& path, int columns,
                                         std::string_view record);

}  // namespace penumbra::nn
