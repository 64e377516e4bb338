#pragma once

#include "app/base/read_file.h"
#include "net/base/reference_policy.h"
#include "net/base/url.h"
#include "net/files/file.h"

#include <optional>
#include <string>
#include <vector>

namespace gs::app {

/// A local file, or why it could not be opened.
struct LocalFile {
  std::optional<net::MappedFile> file;
  std::string path;
  std::string problem;
  std::string folder;  // that the user would have to allow; empty: that is not the problem
};

/// Opens what a file: URL means that a text from `from` refers to, if it may; also where only upper and lower case
/// differ, as in worlds that come from Windows. `given`: the path as the user gave it, exactly; empty for any other.
/// `check` sees the first bytes of a large file before it is mapped.
[[nodiscard]] LocalFile open_local_file(const net::Url& url, const net::ReferencePolicy& policy,
                                        const net::Origin& from, const std::string& given = {},
                                        const net::CheckFirstBytes& check = {});

/// What a world in the file `path` may refer to: its own folder with all below, and what the user `allowed`.
[[nodiscard]] net::ReferencePolicy policy_of_world(const std::string& path, const std::vector<std::string>& allowed);

/// Reads what the file `path` names, as policy_of_world says; files only.
[[nodiscard]] ReadFile reader_beside(const std::string& path, const std::vector<std::string>& allowed);

/// The bytes of a file that was opened.
[[nodiscard]] SharedBytes shared_bytes(net::MappedFile file);

}  // namespace gs::app
