#include "app/loading/resources/text_handler.h"

#include "app/base/text_source.h"
#include "base/gzip.h"
#include "base/text.h"

#include <utility>

namespace gs::app {

void TextHandler::receive(std::span<const std::byte> bytes) {
  if ((full_ || !keep(bytes)) && !std::exchange(full_, true))
    warn(" " + found_.path + ": " + loading_.budget->refusal(Resource::files) + "; left out");
}

void TextHandler::end(const std::optional<std::string>& problem) {
  if (problem) warn(": " + *problem);
  if (full_ || problem) return give(std::nullopt);
  if (!is_gzip(bytes_)) return give(std::string(text_of(bytes_)));
  const UnpackedBytes unpacked = unpack_gzip(bytes_, loading_.budget, Resource::files);
  if (!unpacked.problem) return give(std::string(text_of(unpacked.bytes)));
  warn(" " + found_.path + ": " + *unpacked.problem);
  give(std::nullopt);
}

void TextHandler::missing(const std::string& why) {
  ResourceHandler::missing(why);
  give(std::nullopt);
}

void TextHandler::give(std::optional<std::string> text) {
  drop_bytes();
  loading_.results.add(ResourceUpdates::Text{request_.place, std::move(text), found_.path, source_of(found_.origin)});
}

}  // namespace gs::app
