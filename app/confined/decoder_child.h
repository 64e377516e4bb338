#pragma once

#include "app/base/read_file.h"
#include "app/confined/data_child.h"

#include <cstddef>
#include <span>
#include <string_view>
#include <vector>

namespace gs::app {

/// Content that a child decodes. Movies need FFmpeg, which it loads before it confines itself. A child of volumes keeps
/// one file open, and serves its slices. Children of datasets load the module for scientific formats before they confine
/// themselves: `datasets` serves slices like `volumes`, and `dataset_meshes` imports meshes.
enum class DecoderKind : unsigned char { pictures, movies, volumes, datasets, dataset_meshes };
inline constexpr std::size_t kDecoderKinds = 5;

/// First argument of a decoder child. The others are the name of its kind, and its memory in MiB. Internal; users never
/// pass them.
inline constexpr std::string_view kDecoderArgument = "--confined-decoder";
[[nodiscard]] std::string_view name_of(DecoderKind kind);

/// Imports a file in a child: gets the bytes of a request and of the file. `ask` reads files to which it refers.
/// Returns the bytes of the result.
using ImportFile = std::vector<std::byte> (*)(std::span<const std::byte> request, std::span<const std::byte> file,
                                              const ReadFile& ask);

/// Work of a child for other parts of the program.
struct DecoderWork {
  ImportFile import_file = nullptr;
  MakeOpenData open_volume = nullptr;
  void (*load_datasets)() = nullptr;  // loads the module for scientific formats
};

/// Runs a decoder child: confines this process, then answers requests until the parent closes its socket. The process
/// must have the descriptors of decoder_channel.h, and one thread.
[[noreturn]] void run_decoder_child(std::string_view kind, std::string_view mebibytes, const DecoderWork& work);

}  // namespace gs::app
