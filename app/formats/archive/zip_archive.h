#pragma once

#include "base/budget.h"

#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace gs::app {

/// Returns true if the bytes begin like a ZIP archive.
[[nodiscard]] bool is_zip(std::span<const std::byte> bytes);
/// Returns the name of the first file of a ZIP archive, from its first bytes. If the archive does not state its length,
/// returns more characters. Returns an empty name for other data.
[[nodiscard]] std::string_view first_name_in_zip(std::span<const std::byte> bytes);

/// ZIP archive in memory. Safe for untrusted bytes.
class ZipArchive {
 public:
  /// Opens an archive, or returns a message. The bytes must outlive it.
  [[nodiscard]] static std::variant<ZipArchive, std::string> open(std::span<const std::byte> bytes);

  /// Unpacks the file with this name, in any folder. Memory is charged to `budget` while it is unpacked. Returns a
  /// message if the file is missing, damaged or too large.
  [[nodiscard]] std::variant<std::vector<std::byte>, std::string> read(const std::string& name,
                                                                       const WorldBudget& budget) const;
  /// Returns the paths of the files in the archive, at most 65,536.
  [[nodiscard]] std::vector<std::string> paths() const;
  /// Unpacks the file with this path, as read() does. Returns nullopt if the archive does not have it.
  [[nodiscard]] std::optional<std::variant<std::vector<std::byte>, std::string>> read_path(
      const std::string& path, const WorldBudget& budget) const;

 private:
  struct Opened;
  explicit ZipArchive(std::shared_ptr<Opened> opened) : opened_(std::move(opened)) {}
  std::shared_ptr<Opened> opened_;
};

}  // namespace gs::app
