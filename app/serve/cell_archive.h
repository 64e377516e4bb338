#pragma once

#include "net/cells/cell_source.h"
#include "net/serve/served_folder.h"

#include <map>
#include <memory>
#include <string>
#include <variant>

namespace gs::app {

/// The QNV streams of a folder, as cells. A stream is one stream of cells: its
/// chunks in their order, behind the base: its header and its first chunks, the
/// start of the file as it is. A chunk of records has as head its chunk header
/// and the 48 bytes before the records; other chunks go as they stand in the
/// file, with their header.
class CellArchive : public net::CellLibrary {
 public:
  [[nodiscard]] static std::variant<std::shared_ptr<CellArchive>, std::string> of_folder(const std::string& folder);
  /// As the path of a request over HTTP, a slash before it or not. One source
  /// for all who want the same version.
  [[nodiscard]] std::variant<std::shared_ptr<net::CellSource>, std::string> open(const std::string& path) override;

 private:
  explicit CellArchive(net::ServedFolder folder) : folder_(std::move(folder)) {}
  net::ServedFolder folder_;
  std::map<std::string, std::weak_ptr<net::CellSource>> open_;
};

}  // namespace gs::app
