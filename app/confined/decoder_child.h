#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace gs::app {

/// Content that a child decodes. Movies need FFmpeg, which it loads before it confines itself.
enum class DecoderKind : unsigned char { pictures, movies };

/// First argument of a decoder child; the second one is the name of its kind. Internal; users never pass it.
inline constexpr std::string_view kDecoderArgument = "--confined-decoder";
[[nodiscard]] std::string_view name_of(DecoderKind kind);

/// Returns the bytes of a file to which another one refers, or nullopt and sets the error.
using AskForFile =
    std::function<std::optional<std::vector<std::byte>>(const std::string& reference, std::string& error)>;
/// Imports a file in a child: gets the bytes of a request and of the file. Returns the bytes of the result.
using ImportFile = std::vector<std::byte> (*)(std::span<const std::byte> request, std::span<const std::byte> file,
                                              const AskForFile& ask);

/// Runs a decoder child: confines this process, then answers requests until the parent closes its socket. The process
/// must have the descriptors of decoder_channel.h, and one thread.
[[noreturn]] void run_decoder_child(std::string_view kind, ImportFile import_file);

}  // namespace gs::app
