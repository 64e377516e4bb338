#pragma once

#include "net/file.h"
#include "net/url.h"

#include <optional>
#include <string>

namespace gs::app {

/// A local file, or why it could not be opened.
struct LocalFile {
  std::optional<net::MappedFile> file;
  std::string path;
  std::string problem;
};

/// Opens what a file: URL means; also where only upper and lower case differ, as in worlds that come from Windows.
/// `given`: the path as the user gave it, exactly; empty for any other.
[[nodiscard]] LocalFile open_local_file(const net::Url& url, const std::string& given = {});

}  // namespace gs::app
