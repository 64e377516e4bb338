#pragma once

#include "app/base/read_file.h"
#include "app/base/read_files.h"
#include "net/base/reference_policy.h"
#include "net/base/url.h"
#include "net/files/file.h"

#include <optional>
#include <string>
#include <vector>

namespace gs::app {

/// Local file that was opened, or the reason why it could not be opened.
struct LocalFile {
  std::optional<net::MappedFile> file;
  std::string path;
  std::string problem;
  std::string folder;  // folder that the user must allow first; else empty
};

/// Opens a local file at a file: URL, if `policy` allows a text from `from` to refer to it. Ignores upper and lower
/// case if there is no exact match, for worlds from Windows. `given` is the path exactly as given by the user, or
/// empty. `check` gets the first bytes of a large file before it is mapped.
[[nodiscard]] LocalFile open_local_file(const net::Url& url, const net::ReferencePolicy& policy,
                                        const net::Origin& from, const std::string& given = {},
                                        const net::CheckFirstBytes& check = {});

/// Returns `path` if this file exists, else the path of a file that differs only in upper and lower case. Returns an
/// empty string if there is none. Does not check the policy.
[[nodiscard]] std::string existing_path(const std::string& path);

/// Returns the policy for a world in the file `path`. The world may refer to files in its own folder and its
/// subfolders, and to files that the user `allowed`.
[[nodiscard]] net::ReferencePolicy policy_of_world(const std::string& path, const std::vector<std::string>& allowed);

/// Returns a function that reads files to which the file `path` refers. It applies policy_of_world().
[[nodiscard]] ReadFile reader_beside(const std::string& path, const std::vector<std::string>& allowed);

/// Returns the paths of the files in a folder and its subfolders, relative to it and in order. Omits names that begin
/// with a dot, links to folders, deep folders, and files after the first `most`.
[[nodiscard]] std::vector<std::string> files_below(const std::string& folder, std::size_t most);

/// Returns a function that reads the files in a folder, and answers kFolderReference with their names.
[[nodiscard]] ReadFile folder_reader(const std::string& folder);

/// Reads a local file, or a part of it, for a text from `from`.
[[nodiscard]] FileResult read_local_part(const net::Url& url, const net::ReferencePolicy& policy,
                                         const net::Origin& from, const FileRequest& request);
/// Returns a function that reads several files as reader_beside() does. Upper and lower case matter.
[[nodiscard]] ReadFiles files_beside(const std::string& path, const std::vector<std::string>& allowed);
/// Returns a function that lists folders in the folder of the file `path`, and below. Omits names that begin with '.'.
[[nodiscard]] ListFolder lister_beside(const std::string& path);

/// Returns the bytes of a mapped file. They own the mapping.
[[nodiscard]] SharedBytes shared_bytes(net::MappedFile file);

}  // namespace gs::app
