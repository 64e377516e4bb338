#pragma once

#include "net/cells/cell_source.h"
#include "net/serve/served_folder.h"

#include <map>
#include <memory>
#include <string>
#include <variant>

namespace gs::app {

/// Library that sends the QNV streams of a folder as cells. The header and the first chunks, which are the start of the
/// file, form the protected base. The other chunks follow in their order. The head of a records chunk is its chunk
/// header and the 48 bytes before the records. Other chunks are sent as in the file, with their header.
class CellArchive : public net::CellLibrary {
 public:
  [[nodiscard]] static std::variant<std::shared_ptr<CellArchive>, std::string> of_folder(const std::string& folder);
  /// Opens the file at the path of an HTTP request, with or without a leading slash. All clients of one version share
  /// the source.
  [[nodiscard]] std::variant<std::shared_ptr<net::CellSource>, std::string> open(const std::string& path) override;

 private:
  explicit CellArchive(net::ServedFolder folder) : folder_(std::move(folder)) {}
  net::ServedFolder folder_;
  std::map<std::string, std::weak_ptr<net::CellSource>> open_;
};

}  // namespace gs::app
