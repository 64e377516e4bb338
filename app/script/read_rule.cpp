#include "app/script/read_rule.h"

namespace gs::app::script {
namespace {

bool is_network(const net::Origin& origin) { return origin.is_network(); }

bool same_text_or_site(const net::Origin& a, const net::Origin& b) {
  return is_network(a) && is_network(b) ? a.site() == b.site() : a.url == b.url;
}

}  // namespace

Reading reading(const net::Origin& script, const net::Origin& document, const net::Origin& node) {
  if (same_text_or_site(script, node)) return Reading::allowed;
  const bool of_document = same_text_or_site(document, node);
  // A network Script may read nodes of its document: if a document passes nodes to a PROTO from the network, that PROTO
  // may read them.
  if (is_network(script)) {
    if (!of_document) return Reading::refused;
    return is_network(node) ? Reading::allowed : Reading::confidential;
  }
  if (of_document) return Reading::allowed;
  // Files from public hosts are not confidential.
  return is_network(node) && node.space == net::AddressSpace::global ? Reading::allowed : Reading::confidential;
}

std::string library_key(const net::Origin& script) { return is_network(script) ? script.site() : script.url; }

}  // namespace gs::app::script
