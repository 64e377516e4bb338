#pragma once

#include "net/cells/cell_source.h"
#include "net/serve/served_folder.h"

#include <map>
#include <memory>
#include <string>
#include <variant>

namespace gs::app {

/// Library that sends the QNV streams of a folder as cells. The protected base is the start of the file: header and
/// first chunks. The other chunks follow in the order of the file, each with its chunk header. For a records chunk, the
/// chunk header and the 48 bytes before the records are its head, which is sent separately. Of long values, another
/// stream has the directory (app/streams/cell_wishes.h).
class CellArchive : public net::CellLibrary {
 public:
  [[nodiscard]] static std::variant<std::shared_ptr<CellArchive>, std::string> of_folder(const std::string& folder);
  /// Opens the file at the path of an HTTP request, with or without a leading slash. All clients of the same version of
  /// a file share its source.
  [[nodiscard]] std::variant<std::shared_ptr<net::CellSource>, std::string> open(const std::string& path) override;

 private:
  explicit CellArchive(net::ServedFolder folder) : folder_(std::move(folder)) {}
  net::ServedFolder folder_;
  std::map<std::string, std::weak_ptr<net::CellSource>> open_;
};

}  // namespace gs::app
