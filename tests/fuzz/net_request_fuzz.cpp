// Fuzzes requests to a served folder. No file outside of it may be opened, and all headers of responses must be valid.
#include "net/serve/http_site.h"
#include "tests/app/scratch_folder.h"
#include "tests/fuzz/net_targets.h"

#include <filesystem>
#include <map>

using namespace gs::net;

namespace gs::fuzz {
namespace {

namespace fs = std::filesystem;

/// Folder with a few files, one of them a link that leads out. A file outside of the folder must not be served.
class ServedSample {
 public:
  ServedSample() {
    base_.write("secret", "secret");
    base_.write("www/a.txt", std::string(2000, 'a'));
    base_.write("www/.hidden", "hidden");
    base_.write("www/sub folder/b.wrl", "#VRML V2.0 utf8\n");
    fs::create_symlink("../secret", base_.path("www/way_out"));
    fs::create_symlink("a.txt", base_.path("www/way_in"));
    inode_ = std::get<ServedFile>(root("").open(RequestPath{{"secret"}, false})).stamp.inode;
    options_.type_of = [](const std::string& name) { return ServedType{"text/plain", name.ends_with(".txt")}; };
    options_.list = [](const FolderListing& listing, const FolderRequest& request) {
      const bool json = request.json;
      std::string body = listing.path;
      for (const FolderEntry& entry : listing.entries) body += entry.name + '\n';
      return FolderPage{json ? "application/json" : "text/html", body};
    };
    site_ = std::make_unique<HttpSite>(options_, root("www"), nullptr, [] { return std::string("metrics\n"); });
  }

  [[nodiscard]] HttpSite::Reply answer(const HttpRequest& request) const { return site_->answer(request); }
  [[nodiscard]] std::uint64_t forbidden() const { return inode_; }

 private:
  [[nodiscard]] ServedFolder root(const std::string& name) const {
    return std::get<ServedFolder>(ServedFolder::open(base_.path(name)));
  }
  ScratchFolder base_;
  std::uint64_t inode_ = 0;
  HttpServerOptions options_;
  std::unique_ptr<HttpSite> site_;
};

}  // namespace

/// Fuzzes a request: "METHOD TARGET" in the first line, then one header per line.
bool run_http_request(std::span<const std::byte> bytes) {
  static const ServedSample sample;
  std::string_view text = text_of(bytes);
  const auto line = [&] {
    const std::size_t end = std::min(text.find('\n'), text.size());
    const std::string one(text.substr(0, end));
    text.remove_prefix(std::min(end + 1, text.size()));
    return one;
  };
  HttpRequest request;
  const std::string first = line();
  const std::size_t blank = std::min(first.find(' '), first.size());
  request.method = first.substr(0, blank);
  request.target = first.substr(std::min(blank + 1, first.size()));
  const std::map<std::string, std::string*> headers = {{"Range", &request.range},
                                                       {"Accept", &request.accept},
                                                       {"Origin", &request.origin},
                                                       {"Accept-Encoding", &request.accept_encoding},
                                                       {"If-Match", &request.conditions.if_match},
                                                       {"If-None-Match", &request.conditions.if_none_match},
                                                       {"If-Modified-Since", &request.conditions.if_modified_since},
                                                       {"If-Unmodified-Since", &request.conditions.if_unmodified_since},
                                                       {"If-Range", &request.conditions.if_range}};
  while (!text.empty()) {
    const std::string one = line();
    const std::size_t colon = one.find(": ");
    if (colon == std::string::npos) continue;
    const auto known = headers.find(one.substr(0, colon));
    if (known != headers.end()) *known->second = one.substr(colon + 2);
    if (one.starts_with("Host: ")) request.hosts.push_back(one.substr(colon + 2));
  }
  if (request.hosts.empty()) request.hosts = {"localhost"};
  const HttpSite::Reply reply = sample.answer(request);
  const auto* answer = std::get_if<HttpAnswer>(&reply);
  require(answer);  // the site has no made files, so the response is ready at once
  require(answer->status >= 200 && answer->status < 600);
  for (const auto& [name, value] : answer->headers) {
    require(!name.empty());
    for (const char c : name + value) require(static_cast<unsigned char>(c) >= 0x20 && c != 0x7f);
  }
  if (answer->file) require(answer->stamp.inode != sample.forbidden());
  for (const AnswerPart& part : answer->parts)
    if (part.text.empty())
      require(answer->file && part.range.begin < part.range.end && part.range.end <= answer->stamp.size);
  return answer->status == 200 || answer->status == 206;
}

}  // namespace gs::fuzz
