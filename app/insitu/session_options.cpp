#include "app/insitu/session_options.h"

#include <algorithm>
#include <cmath>
#include <cstring>

namespace gs::app::insitu {
namespace {

std::string text_or(const char* text, const char* fallback) { return text && *text ? text : fallback; }

}  // namespace

std::variant<SessionOptions, std::string> session_options(const gs_insitu_options& given) {
  gs_insitu_options options;
  gs_insitu_options_init(&options, sizeof options);
  if (given.size < sizeof(std::size_t) || given.size > sizeof options)
    return "the options come from a newer version of the header; expected version " +
           std::to_string(GS_INSITU_VERSION) + ", and gs_insitu_options_init() before";
  std::memcpy(&options, &given, given.size);
  SessionOptions result;
  result.title = text_or(options.title, "simulation");
  result.folder = text_or(options.folder, "");
  result.bind = text_or(options.bind, "127.0.0.1");
  result.token_file = text_or(options.token_file, "");
  result.live_file = text_or(options.live_file, "");
  result.field = text_or(options.field, "");
  result.serve = options.serve != 0;
  result.background = options.background != 0;
  result.thin = options.thin != 0;
  if (options.port < 0 || options.port > 65535)
    return "port " + std::to_string(options.port) + " is out of range; expected 0 to 65535";
  result.port = static_cast<std::uint16_t>(options.port);
  if (!(options.error >= 0) || !std::isfinite(options.error) || !(options.relative_error >= 0) ||
      !(options.relative_error < 1))
    return "the error is invalid; expected an error of 0 or more, and a relative_error from 0 to below 1";
  if (options.error == 0 && options.relative_error == 0)
    return "the error is 0; expected an error or a relative_error above 0";
  result.error = options.error;
  result.relative_error = options.relative_error;
  const bool usual = options.max_share == GS_INSITU_USUAL_SHARE;
  if (!usual && (!(options.max_share >= 0) || !(options.max_share <= 1)))
    return "max_share is invalid; expected 0 to 1, or GS_INSITU_USUAL_SHARE";
  result.usual_share = usual && result.serve && result.folder.empty();
  result.max_share = !usual ? options.max_share : result.usual_share ? kShareOfKept : 0;
  if (options.every < 1) return "every is " + std::to_string(options.every) + "; expected 1 or more";
  result.every = options.every;
  result.max_memory = std::max<std::uint64_t>(options.max_memory, 1);
  result.threads = static_cast<unsigned>(std::clamp(options.threads, 1, 256));
  if (!result.serve && result.folder.empty()) return "there is no output; expected a folder, or serve = 1";
  if (options.log)
    result.log = [log = options.log, context = options.log_context](const std::string& message) {
      log(context, message.c_str());
    };
  return result;
}

}  // namespace gs::app::insitu
