#pragma once

#include "app/base/read_file.h"
#include "net/base/reference_policy.h"
#include "net/base/url.h"
#include "net/files/file.h"

#include <optional>
#include <string>
#include <vector>

namespace gs::app {

/// Opened local file, or the reason why it could not be opened.
struct LocalFile {
  std::optional<net::MappedFile> file;
  std::string path;
  std::string problem;
  std::string folder;  // folder that the user would have to allow; empty if that is not the problem
};

/// Opens the file of a file: URL that a text from `from` refers to, if the policy allows it. Also finds names that
/// differ only in case, as in worlds from Windows. `given` is the exact path from the user, or empty. `check` gets the
/// first bytes of a large file before it is mapped.
[[nodiscard]] LocalFile open_local_file(const net::Url& url, const net::ReferencePolicy& policy,
                                        const net::Origin& from, const std::string& given = {},
                                        const net::CheckFirstBytes& check = {});

/// Returns the files that a world in the file `path` may refer to: its own folder with subfolders, and those that the
/// user `allowed`.
[[nodiscard]] net::ReferencePolicy policy_of_world(const std::string& path, const std::vector<std::string>& allowed);

/// Returns a reader of files that the file `path` refers to, under policy_of_world().
[[nodiscard]] ReadFile reader_beside(const std::string& path, const std::vector<std::string>& allowed);

/// Returns the bytes of a mapped file, which they own.
[[nodiscard]] SharedBytes shared_bytes(net::MappedFile file);

}  // namespace gs::app
