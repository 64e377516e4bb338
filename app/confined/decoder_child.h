#pragma once

#include <string_view>

namespace gs::app {

/// Content that a child decodes. Movies need FFmpeg, which it loads before it confines itself.
enum class DecoderKind : unsigned char { pictures, movies };

/// First argument of a decoder child; the second one is the name of its kind. Internal; users never pass it.
inline constexpr std::string_view kDecoderArgument = "--confined-decoder";
[[nodiscard]] std::string_view name_of(DecoderKind kind);

/// Runs a decoder child: confines this process, then answers requests until the parent closes its socket. The process
/// must have the descriptors of decoder_channel.h, and one thread.
[[noreturn]] void run_decoder_child(std::string_view kind);

}  // namespace gs::app
