#include "app/base/text_source.h"

namespace gs::app {

std::shared_ptr<const vrml::TextSource> source_of(const net::Origin& origin) {
  return std::make_shared<const vrml::TextSource>(
      vrml::TextSource{origin.url, static_cast<std::uint8_t>(origin.space)});
}

net::Origin origin_of(const std::shared_ptr<const vrml::TextSource>& source) {
  if (!source) return {"data:", net::AddressSpace::global};
  return {source->url, static_cast<net::AddressSpace>(source->address_space)};
}

}  // namespace gs::app
