#pragma once

#include "app/base/read_file.h"
#include "app/formats/datasets/arrays/array_file.h"
#include "base/budget.h"

#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace gs::app {

/// Arrays of an open file, found by their paths, and its bytes. One thread at a time.
class DatasetTree {
 public:
  DatasetTree(std::shared_ptr<ArrayFile> file, SharedBytes content, WorldBudget budget);

  [[nodiscard]] const std::vector<ArrayInfo>& arrays() const { return file_->arrays(); }
  [[nodiscard]] const ArrayInfo* find(std::string_view path) const;
  /// Returns an array that find() would return. Its index is that in arrays().
  [[nodiscard]] std::optional<std::size_t> index_of(std::string_view path) const;
  [[nodiscard]] bool has_group(std::string_view path) const;
  [[nodiscard]] const std::vector<std::string>& groups() const { return file_->groups(); }

  /// Returns an attribute of an array or a group, or null. The result is valid as long as the tree.
  [[nodiscard]] const ArrayAttribute* attribute(const std::string& path, std::string_view name);
  /// Returns the text of an attribute, or an empty text.
  [[nodiscard]] std::string text(const std::string& path, std::string_view name);
  /// Returns the numbers of an attribute; numbers in a text count, too.
  [[nodiscard]] std::vector<double> numbers(const std::string& path, std::string_view name);
  [[nodiscard]] std::optional<double> number(const std::string& path, std::string_view name);

  /// Reads elements of an array as doubles: all of them, or `count` rows of its first axis from `first` on. Returns a
  /// message if there are too many for memory, or if they cannot be read.
  [[nodiscard]] std::variant<std::vector<double>, std::string> values(const std::string& path);
  [[nodiscard]] std::variant<std::vector<double>, std::string> rows(const std::string& path, std::uint64_t first,
                                                                    std::uint64_t count);

  /// Returns the numbers of a coordinate, unpacked by `scale_factor` and `add_offset`, and keeps them; empty if they
  /// cannot be read or are too many.
  [[nodiscard]] const std::vector<double>& coordinate(const std::string& path);

  [[nodiscard]] const std::shared_ptr<ArrayFile>& file() const { return file_; }
  [[nodiscard]] const SharedBytes& content() const { return content_; }
  [[nodiscard]] const WorldBudget& budget() const { return budget_; }

 private:
  std::shared_ptr<ArrayFile> file_;
  SharedBytes content_;
  WorldBudget budget_;
  std::map<std::string, std::size_t, std::less<>> places_;
  std::map<std::string, std::vector<ArrayAttribute>> attributes_;
  std::map<std::string, std::vector<double>> coordinates_;
};

/// Returns the part of a path after its last slash, and the part before it ("/" for the root).
[[nodiscard]] std::string name_of_path(std::string_view path);
[[nodiscard]] std::string folder_of_path(std::string_view path);
/// Returns a message if over 16.7 million of the `count` elements of an array were never written. Reading them would
/// take long, although the file is small. Otherwise, or if the written elements are unknown, returns an empty text.
[[nodiscard]] std::string unwritten_problem(ArrayFile& file, std::size_t array, double count);
/// Converts numbers as ArrayFile::read() gives them to doubles.
[[nodiscard]] std::vector<double> doubles_of(NumberType type, std::span<const std::byte> bytes);

}  // namespace gs::app
