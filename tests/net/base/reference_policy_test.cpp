// Tests of allowed references. docs/security.md names these tests.
#include "net/base/reference_policy.h"

#include <catch2/catch.hpp>

#include <filesystem>
#include <fstream>
#include <string>
#include <utility>

#include "tests/net/load_helpers.h"

namespace {

using namespace gs::net;
using gs::net::test::TemporaryFolder;
namespace fs = std::filesystem;

std::string refusal(const ReferencePolicy& policy, const Origin& from, const std::string& to) {
  const auto why = policy.refuse(from, parse_url(to));
  return why ? why->message : "";
}
std::string refusal(const std::string& from, const std::string& to) {
  return refusal(ReferencePolicy(), {from, AddressSpace::global}, to);
}

std::string made(const TemporaryFolder& folder, const std::string& name) {
  const std::string path = folder / name;
  fs::create_directories(fs::path(path).parent_path());
  std::ofstream(path) << name;
  return path;
}

TEST_CASE("lets a document from the network refer only to the network") {
  const std::string file = "file:///etc/passwd";
  for (const char* from :
       {"http://a/b.wrl", "https://a/b.wrl", "data:model/vrml,x", "cells://a/b", "memory:a", "b.wrl", "javascript:x"}) {
    INFO(from);
    ReferencePolicy all;
    all.allow("/");
    CHECK(refusal(all, {from, AddressSpace::loopback}, file).find("may not refer to file:") != std::string::npos);
    CHECK(all.refuse_file({from, AddressSpace::loopback}, "/etc/passwd"));
  }
  CHECK(refusal("http://a/", file) ==
        "a document of http: may not refer to file:; expected one of data, http, https, ftp, cells");
  CHECK(refusal("http://a/", "http://b/").empty());
  CHECK(refusal("http://a/", "data:,x").empty());
  CHECK(refusal("http://a/", "cells://b/x").empty());
}

TEST_CASE("allows all references of the user") {
  for (const char* to : {"file:///etc/passwd", "http://user:password@localhost/", "cells://127.0.0.1:53/x", "data:,x"})
    CHECK(refusal("", to).empty());
  CHECK(Origin{}.reach() == AddressSpace::special);
  CHECK(refusal("", "gopher://a") ==
        "the scheme gopher: is not known; expected one of file, data, http, https, ftp, ssh, cells");
  CHECK(refusal("", "a/b") == "it has no scheme; expected one of file, data, http, https, ftp, ssh, cells");
}

TEST_CASE("refuses URLs without a host for every origin if their scheme requires one") {
  for (const char* to : {"http:///user:pw@127.0.0.1:1/x", "http:/127.0.0.1/x", "http:x", "https://:443/x",
                         "ftp:///127.0.0.1:1021/x", "ftp:/x", "cells:///x", "http://a:65536/"})
    for (const char* from : {"", "file:///w/w.wrl", "http://a/b.wrl", "ftp://a/b.wrl"}) {
      INFO(from << " to " << to);
      CHECK(refusal(from, to) ==
            "it has no host or an invalid port; expected " + parse_url(to).scheme + "://HOST:PORT/PATH");
    }
}

TEST_CASE("normalises the site of a text") {
  const auto site = [](const char* url) { return Origin{url, AddressSpace::global}.site(); };
  CHECK(site("HTTP://A.example:80/x") == site("http://a.example/y"));
  CHECK(site("http://a.example:81/") != site("http://a.example/"));
  CHECK(site("http://a.example/") != site("https://a.example/"));
  CHECK(site("http:///a.example/") != site("http:///b.example/"));
  CHECK(site("FILE:///a") == site("file:///b"));
  CHECK(Origin{"FILE:///a"}.is_file());
  // A relative reference keeps the typed HOST:80 and the password.
  CHECK(refusal("http://user:pw@A:80/w.wrl", "http://user:pw@a/x").empty());
}

TEST_CASE("lets a file refer to allowed folders and below, after following links") {
  const TemporaryFolder folder;
  const std::string world = made(folder, "worlds/sub/a.wrl"), beside = made(folder, "worlds/sub/b c.wrl"),
                    below = made(folder, "worlds/sub/deep/c.wrl"), above = made(folder, "worlds/d.wrl"),
                    near = made(folder, "worlds/subway/e.wrl");
  const Origin from{url_of_path(world).text()};
  ReferencePolicy policy;
  const auto refused = [&](const std::string& path) {
    return !refusal(policy, from, url_of_path(path).text()).empty();
  };
  CHECK(refused(beside));  // no folder is allowed yet
  policy.allow(folder / "worlds/sub");
  CHECK_FALSE(refused(world));
  CHECK_FALSE(refused(beside));
  CHECK_FALSE(refused(below));
  CHECK_FALSE(refused(folder / "worlds/sub/deep/../b c.wrl"));
  CHECK(refused(above));
  CHECK(refused(near));
  CHECK(refused(folder / "worlds/sub/../d.wrl"));
  CHECK(refused("/etc/passwd"));
  CHECK_FALSE(refused(folder / "worlds/nothing.wrl"));  // the file is missing; opening it reports that
  // The target of a symbolic link decides.
  fs::create_symlink(above, folder / "worlds/sub/out.wrl");
  fs::create_directory_symlink(folder / "worlds", folder / "worlds/sub/up");
  fs::create_symlink("b c.wrl", folder / "worlds/sub/in.wrl");
  CHECK(refused(folder / "worlds/sub/out.wrl"));
  CHECK(refused(folder / "worlds/sub/up/d.wrl"));
  CHECK_FALSE(refused(folder / "worlds/sub/in.wrl"));
  fs::create_directory_symlink(folder / "worlds/sub", folder / "way");
  ReferencePolicy by_link;
  by_link.allow(folder / "way");
  CHECK_FALSE(by_link.refuse_file(from, beside));
  // A single file can be allowed without its neighbours.
  policy.allow(above);
  CHECK_FALSE(refused(above));
  CHECK(refused(near));
}

TEST_CASE("names the folder to allow in a refusal") {
  const TemporaryFolder folder;
  const std::string world = made(folder, "a/b/w.wrl"), texture = made(folder, "a/textures/x.png");
  ReferencePolicy policy;
  policy.allow(folder / "a/b");
  const std::string wanted = fs::canonical(folder / "a/textures").string();
  const auto why = policy.refuse({url_of_path(world).text()}, url_of_path(texture));
  REQUIRE(why);
  CHECK(why->folder == wanted);
  CHECK(why->message == "it lies outside of the world's folder; --allow " + wanted + " allows it");
  policy.allow(why->folder);
  CHECK_FALSE(policy.refuse({url_of_path(world).text()}, url_of_path(texture)));
  // For these references, no folder could be allowed.
  CHECK(ReferencePolicy().refuse({"http://a/"}, url_of_path(texture))->folder.empty());
  CHECK(ReferencePolicy().refuse({"https://a/"}, parse_url("http://a/"))->folder.empty());
}

TEST_CASE("refuses user names and passwords from a document") {
  for (const char* from : {"http://a/w.wrl", "https://a/w.wrl", "file:///w.wrl", "cells://a/w"})
    for (const char* to : {"https://user@b/", "https://user:password@b/", "https://@b/", "https://x@a:1@b/"}) {
      INFO(from << " " << to);
      CHECK(refusal(from, to) == "a document may not specify a user or password; expected https://HOST/PATH");
    }
  CHECK(refusal("file:///w.wrl", "cells://user:password@b/x").find("password") != std::string::npos);
  // A relative reference keeps the user name and password of the base.
  const Url base = parse_url("http://user:password@a/w.wrl");
  CHECK(refusal(base.text(), resolve(base, parse_url("x.png")).text()).empty());
  CHECK_FALSE(refusal(base.text(), "http://user:password@b/x.png").empty());
  CHECK_FALSE(refusal(base.text(), "https://user:password@a/x.png").empty());
}

TEST_CASE("refuses unencrypted references from https") {
  CHECK(refusal("https://a/", "http://a/") ==
        "a document of https: may not refer to http:, which is not protected against changes in transit; expected "
        "https:");
  CHECK_FALSE(refusal("https://a/", "cells://a/x").empty());
  const std::pair<const char*, const char*> allowed[] = {{"https://a/", "https://b/"},
                                                         {"https://a/", "data:,x"},
                                                         {"http://a/", "https://b/"},
                                                         {"cells://a/", "http://b/"},
                                                         {"file:///a", "http://b/"}};
  for (const auto& [from, to] : allowed) CHECK(refusal(from, to).empty());
}

TEST_CASE("refuses datagrams to the ports of system services") {
  CHECK(refusal("http://a/", "cells://b:53/x") ==
        "a document may not send datagrams to port 53; expected one from 1024 on");
  CHECK_FALSE(refusal("file:///a", "cells://b:1023/x").empty());
  for (const char* to : {"cells://b:1024/x", "cells://b/x"}) CHECK(refusal("http://a/", to).empty());
}

TEST_CASE("refuses FTP to the ports of system services") {
  CHECK(refusal("http://a/", "ftp://b:25/x") ==
        "a document may not send FTP commands to port 25; expected 21, or one from 1024 on");
  CHECK_FALSE(refusal("file:///a", "ftp://b:1023/x").empty());
  for (const char* to : {"ftp://b/x", "ftp://b:21/x", "ftp://b:2121/x"}) CHECK(refusal("http://a/", to).empty());
  CHECK_FALSE(refusal("https://a/", "ftp://b/x").empty());
  CHECK_FALSE(refusal("http://a/", "ftp://somebody:secret@b/x").empty());
  CHECK(refusal("", "ftp://b:25/x").empty());
}

TEST_CASE("lets only the user open ssh: URLs, and a document of an account its own folder") {
  CHECK(refusal("", "ssh://host/etc/passwd").empty());
  for (const char* from :
       {"http://host/a.wrl", "https://host/a.wrl", "file:///data/a.wrl", "data:,x", "cells://host/a"})
    CHECK(refusal(from, "ssh://host/data/b.wrl") ==
          "only the user may open ssh: URLs; a document may not refer to them");
  const std::string world = "ssh://ann@host/data/run/a.wrl";
  const auto outside = "it lies outside of the world's folder on its host";
  CHECK(refusal(world, "ssh://ann@host/data/run/b.wrl").empty());
  CHECK(refusal(world, "ssh://ann@host/data/run/sub/b.wrl").empty());
  CHECK(refusal(world, "ssh://ann@host/data/run/sub/../b.wrl").empty());
  for (const char* to :
       {"ssh://ann@host/data/b.wrl", "ssh://ann@host/data/run/../b.wrl", "ssh://ann@host/data/running/b",
        "ssh://ann@host/data/run", "ssh://host/data/run/b.wrl", "ssh://bob@host/data/run/b.wrl",
        "ssh://ann@host:2222/data/run/b.wrl", "ssh://other/data/run/b.wrl", "ssh://ann@host/"})
    CHECK(refusal(world, to) == outside);
  CHECK(refusal(world, "file:///data/run/b.wrl").find("may not refer to file:") != std::string::npos);
  CHECK(refusal(world, "http://host/b.wrl").find("not protected") != std::string::npos);
  CHECK(refusal(world, "https://host/b.png").empty());
  // A part of a world may refer to the folder of the opened world.
  ReferencePolicy opened;
  opened.allow_ssh(parse_url(world));
  const Origin part{"ssh://ann@host/data/run/sub/b.wrl", AddressSpace::local};
  CHECK(refusal(opened, part, "ssh://ann@host/data/run/picture.png").empty());
  CHECK(refusal(opened, part, "ssh://ann@host/data/picture.png") == outside);
  CHECK(opened.ssh_folder(part, parse_url("ssh://ann@host/data/run/picture.png")) == "/data/run/");
  CHECK(opened.ssh_folder({}, parse_url("ssh://ann@host/etc/x")).empty());
  CHECK(refusal(opened, {"ssh://bob@host/data/run/sub/b.wrl"}, "ssh://ann@host/data/run/picture.png") == outside);
  CHECK(part.is_ssh());
  CHECK_FALSE(part.is_network());
}

TEST_CASE("limits which hosts a document may reach, depending on its address space") {
  CHECK(Origin{"file:///a", AddressSpace::global}.reach() == AddressSpace::loopback);
  CHECK(Origin{"http://a/", AddressSpace::global}.reach() == AddressSpace::global);
  CHECK(Origin{"http://a/", AddressSpace::local}.reach() == AddressSpace::local);
  CHECK(Origin{"http://a/", AddressSpace::special}.reach() == AddressSpace::loopback);
  CHECK(refuse_host(AddressSpace::global, AddressSpace::loopback, "127.0.0.1") ==
        "the address 127.0.0.1 is of this machine; a document of the Internet may not reach it");
  CHECK(refuse_host(AddressSpace::local, AddressSpace::loopback));
  CHECK(refuse_host(AddressSpace::loopback, AddressSpace::special));
  CHECK_FALSE(refuse_host(AddressSpace::special, AddressSpace::special));
  CHECK_FALSE(refuse_host(AddressSpace::local, AddressSpace::local));
  CHECK_FALSE(refuse_host(AddressSpace::local, AddressSpace::global));
}

TEST_CASE("escapes file names as references") {
  const std::pair<const char*, const char*> references[] = {
      {"a b#c?%.raw", "a%20b%23c%3F%25.raw"},
      {"dir\\x.raw", "dir/x.raw"},
      {"C:\\x.raw", "C%3A/x.raw"},
      {"../x", "../x"},
      {"/etc/x", "/etc/x"},
      {"//host/x", "/host/x"},
      {"\\\\host\\x", "/host/x"},
  };
  for (const auto& [path, reference] : references) CHECK(reference_of_path(path) == reference);
  const Url base = parse_url("http://a/b/c.nhdr");
  CHECK(resolve(base, parse_url(reference_of_path("http://evil/x"))).text() == "http://a/b/http%3A//evil/x");
  CHECK(path_of_url(resolve(url_of_path("/w/a.nhdr"), parse_url(reference_of_path("x #%41.raw")))) == "/w/x #%41.raw");
}

}  // namespace
