// Tests of grouping, sharing and prototypes: different notations of one world that must look alike.
#include "tests/app/pairs.h"

#include <cmath>

namespace gs::app::pairs_structure_test {

using namespace pairs;

namespace {

const std::string kView =
    "NavigationInfo { headlight FALSE }\nViewpoint { position 2.2 2.4 6 orientation -0.74 0.66 0.12 0.55 }\n"
    "DirectionalLight { direction -0.3 -1 -0.6 ambientIntensity 0.4 }\n";
const std::string kBall =
    "Shape { appearance Appearance { material Material { diffuseColor 0.9 0.3 0.2 } } geometry Sphere { radius 0.7 } "
    "} ";
const std::string kBlock =
    "Shape { appearance Appearance { material Material { diffuseColor 0.2 0.9 0.3 } texture PixelTexture { image 2 2 3 "
    "0xff4040 0x40ff40 0x4040ff 0xffff40 } } geometry Box { size 1 1.4 0.6 } } ";

std::string moved(const std::string& fields, const std::string& children) {
  return "Transform { " + fields + " children [ " + children + " ] }\n";
}

}  // namespace

TEST_CASE("draws the children of all grouping nodes (VRML97 4.6.5)") {
  Studio studio;
  const std::string plain = kView + moved("translation 0.5 0 0", kBall) + kBlock;
  const std::string ball = moved("translation 0.5 0 0", kBall);
  for (const std::string group :
       {"Group { children [ % ] }", "Transform { children [ % ] }", "Anchor { children [ % ] }",
        "Collision { children [ % ] }",
        "Collision { collide FALSE proxy Shape { geometry Box { size 9 9 9 } } children [ % ] }",
        "Switch { whichChoice 0 choice Group { children [ % ] } }",
        "Switch { whichChoice 1 choice [ Shape { geometry Box { size 5 5 5 } } Group { children [ % ] } ] }",
        "LOD { level [ Group { children [ % ] } Shape { geometry Box { size 5 5 5 } } ] range 100 }",
        "LOD { level [ Shape { geometry Box { size 5 5 5 } } Group { children [ % ] } ] range 0.5 }",
        "LOD { level Group { children [ % ] } range [ 1 2 ] }",
        "Group { children Group { children Group { children [ % ] } } }"}) {
    std::string text = group;
    check_alike(studio, group, kView + text.replace(text.find('%'), 1, ball) + kBlock, plain);
  }
  const std::string nothing =
      "Switch { whichChoice -1 choice Shape { geometry Box { size 5 5 5 } } } Switch { whichChoice 4 choice "
      "Shape { geometry Box { size 5 5 5 } } } LOD { }";
  check_alike(studio, "nothing chosen", kView + ball + nothing + kBlock, plain, 0);
  CHECK(studio.old_worlds() >= 24);
}

TEST_CASE("ignores wrong bounding boxes (VRML97 4.6.4)") {
  Studio studio;
  const std::string ball = moved("translation 0.5 0 0", kBall);
  const render::Image plain = studio.picture(kView + ball + kBlock);
  for (const std::string group : {"Group", "Transform", "Anchor", "Collision", "Inline"})
    for (const std::string box :
         {"bboxSize 0.01 0.01 0.01", "bboxSize 1 1 1 bboxCenter 500 0 -90", "bboxSize 0 0 0 bboxCenter 7 7 7"}) {
      INFO(group << ' ' << box);
      const std::string inside = group == "Inline" ? " url \"in.wrl\" }" : " children [ " + ball + " ] }";
      const Files files{{"main.wrl", kView + group + " { " + box + inside + kBlock}, {"in.wrl", ball}};
      CHECK(compare_pictures(plain, studio.picture(files)).pixels == 0);
      (void)check_vrml1(studio, files, 12);
    }
  CHECK(studio.old_worlds() >= 15);
}

TEST_CASE("draws equal pictures for joined and for separate transformations (VRML97 6.52)") {
  Studio studio;
  const auto alike = [&](const std::string& what, const std::string& a, const std::string& b) {
    check_alike(studio, what, kView + a, kView + b, 20);
  };
  const std::string fields[] = {"translation 0.4 0.2 -0.3", "center 0.3 0 0.2", "rotation 1 2 0.5 0.8",
                                "scaleOrientation 0 0 1 0.6", "scale 1.5 0.7 1"};
  alike("one and six", moved(fields[0] + " " + fields[1] + " " + fields[2] + " " + fields[3] + " " + fields[4], kBlock),
        moved(fields[0],
              moved("translation 0.3 0 0.2",
                    moved(fields[2], moved("rotation 0 0 1 0.6",
                                           moved(fields[4], moved("rotation 0 0 1 -0.6",
                                                                  moved("translation -0.3 0 -0.2", kBlock))))))));
  alike("axis of any length", moved("rotation 0 0.01 0 0.8", kBlock), moved("rotation 0 5 0 0.8", kBlock));
  alike("scale and measures",
        moved("scale 0.5 2 0.25",
              "Shape { appearance Appearance { material Material { } } geometry Box { size 2 1 4 } }"),
        "Shape { appearance Appearance { material Material { } } geometry Box { size 1 2 1 } }");
  const std::string wedge =
                        "Shape { appearance Appearance { material Material { } } geometry IndexedFaceSet { coord "
                        "Coordinate { point [ ",
                    faces = " ] } coordIndex [ 0 1 2 -1 0 3 1 -1 1 3 2 -1 2 3 0 -1 ] } }";
  // Normals follow the surface, not the scale.
  alike("scaled corners", moved("scale 1 3 0.5", wedge + "0 0 1, 1 0 0, 0 0.5 0, -0.4 -0.3 -0.5" + faces),
        wedge + "0 0 0.5, 1 0 0, 0 1.5 0, -0.4 -0.9 -0.25" + faces);
  alike("mirrored", moved("scale -1 1 1", wedge + "0 0 1, 1 0 0, 0 1 0, -0.4 -0.3 -0.5" + faces),
        wedge + "0 0 1, 0 1 0, -1 0 0, 0.4 -0.3 -0.5" + " ] } coordIndex [ 0 1 2 -1 0 3 1 -1 1 3 2 -1 2 3 0 -1 ] } }");
  CHECK(studio.old_worlds() >= 10);
}

TEST_CASE("draws the same view from Viewpoints alone and in a group (VRML97 6.53)") {
  Studio studio;
  const std::string light = "NavigationInfo { headlight FALSE } DirectionalLight { direction -0.3 -1 -0.6 } ";
  check_alike(studio, "moved",
              light + moved("translation 1 2 3", "Viewpoint { position 0 0 2 orientation 1 0 0 -0.3 }") + kBlock,
              light + "Viewpoint { position 1 2 5 orientation 1 0 0 -0.3 }" + kBlock);
  check_alike(studio, "turned", light + moved("rotation 0 1 0 0.5", "Viewpoint { position 0 0 4 }") + kBlock,
              light + "Viewpoint { position " + number(4 * std::sin(0.5)) + " 0 " + number(4 * std::cos(0.5)) +
                  " orientation 0 1 0 0.5 }" + kBlock);
  check_alike(studio, "scaled", light + moved("scale 2 2 2", "Viewpoint { position 0 0 2 }") + kBlock,
              light + "Viewpoint { position 0 0 4 }" + kBlock);
  CHECK(studio.old_worlds() >= 6);
}

TEST_CASE("draws Billboards like shapes that are turned by hand (VRML97 6.6)") {
  Studio studio;
  const std::string light = "NavigationInfo { headlight FALSE } DirectionalLight { direction -0.3 -1 -0.6 } ";
  const std::string side = "Viewpoint { position 4 0 4 orientation 0 1 0 0.78539816 }\n";
  check_alike(studio, "about Y", light + side + "Billboard { children " + kBlock + " }",
              light + side + moved("rotation 0 1 0 0.78539816", kBlock));
  check_alike(studio, "about Y, moved",
              light + side + moved("translation 1 0 1", "Billboard { children " + kBlock + " }"),
              light + side + moved("translation 1 0 1 rotation 0 1 0 0.78539816", kBlock));
  const std::string above = "Viewpoint { position 0 3 3 orientation 1 0 0 -0.78539816 }\n";
  check_alike(studio, "about any axis", light + above + "Billboard { axisOfRotation 0 0 0 children " + kBlock + " }",
              light + above + moved("rotation 1 0 0 -0.78539816", kBlock));
  check_alike(studio, "in a turned group",
              light + side + moved("rotation 0 1 0 1.3", "Billboard { children " + kBlock + " }"),
              light + side + moved("rotation 0 1 0 0.78539816", kBlock));
  CHECK(studio.old_worlds() >= 4);
}

TEST_CASE("draws USE like a copy (VRML97 4.6.2)") {
  Studio studio;
  const std::string material = "Material { diffuseColor 0.8 0.3 0.2 }",
                    texture = "PixelTexture { image 2 1 3 0xff4040 0x4040ff }", box = "Box { size 1 1 1 }";
  const auto world = [&](const std::string& a, const std::string& b, const std::string& c, const std::string& d) {
    return kView + "Shape { appearance Appearance { material " + (a.empty() ? "DEF M " : "") + material + " texture " +
           (b.empty() ? "DEF T " : "") + texture + " } geometry " + (c.empty() ? "DEF G " : "") + box + " } " +
           moved("translation 1.2 0.3 0", "Shape { appearance Appearance { material " + (a.empty() ? "USE M" : a) +
                                              " texture " + (b.empty() ? "USE T" : b) + " } geometry " +
                                              (c.empty() ? "USE G" : c) + " }") +
           d;
  };
  const std::string copied = world(material, texture, box, "");
  check_alike(studio, "of a Material", world("", texture, box, ""), copied, 0);
  check_alike(studio, "of a texture", world(material, "", box, ""), copied, 0);
  check_alike(studio, "of a geometry", world(material, texture, "", ""), copied, 0);
  check_alike(studio, "of all", world("", "", "", ""), copied, 0);
  check_alike(studio, "of a Shape", kView + "DEF S " + kBlock + moved("translation 1.3 0 0", "USE S"),
              kView + kBlock + moved("translation 1.3 0 0", kBlock), 0);
  check_alike(studio, "of a group",
              kView + "DEF S Group { children [ " + kBlock + kBall + " ] }" + moved("translation 1.3 0 0", "USE S"),
              kView + kBlock + kBall + moved("translation 1.3 0 0", kBlock + kBall), 0);
  CHECK(studio.old_worlds() >= 12);
}

TEST_CASE("draws Inlines, PROTOs and EXTERNPROTOs like their content (VRML97 4.8, 4.9, 6.25)") {
  Studio studio;
  const std::string body = kBlock + moved("translation -1 0.5 0 rotation 0 0 1 0.4", kBall);
  const Files pasted{{"main.wrl", kView + moved("rotation 0 1 0 0.3", body)}};
  check_alike(studio, "Inline",
              Files{{"main.wrl", kView + moved("rotation 0 1 0 0.3", "Inline { url \"b.wrl\" }")}, {"b.wrl", body}},
              pasted, 0);
  check_alike(studio, "Inline in an Inline",
              Files{{"main.wrl", kView + moved("rotation 0 1 0 0.3", "Inline { url [ \"none.wrl\" \"b.wrl\" ] }")},
                    {"b.wrl", "Inline { url \"c.wrl\" }"},
                    {"c.wrl", body}},
              pasted, 0);
  const std::string group = "Group { children [ " + body + " ] }";
  check_alike(studio, "PROTO",
              Files{{"main.wrl", kView + "PROTO P [ ] { " + group + " } " + moved("rotation 0 1 0 0.3", "P { }")}},
              pasted, 0);
  check_alike(
      studio, "PROTO in a PROTO",
      Files{{"main.wrl",
             kView + "PROTO Q [ ] { PROTO P [ field SFRotation r 0 1 0 0 ] { Transform { rotation IS r children [ " +
                 body + " ] } } P { r 0 1 0 0.3 } } Q { }"}},
      pasted, 0);
  for (const std::string url : {"\"lib.wrl\"", "\"lib.wrl#P\"", "[ \"none.wrl#P\" \"lib.wrl#P\" ]"})
    check_alike(studio, "EXTERNPROTO " + url,
                Files{{"main.wrl", kView + "EXTERNPROTO P [ ] " + url + " " + moved("rotation 0 1 0 0.3", "P { }")},
                      {"lib.wrl", "PROTO P [ ] { " + group + " }"}},
                pasted, 0);
  check_alike(studio, "children by IS",
              Files{{"main.wrl", kView +
                                     "PROTO P [ field MFNode inside [ ] field SFVec3f at 0 0 0 ] { Transform { "
                                     "rotation 0 1 0 0.3 translation IS at children IS inside } } P { inside [ " +
                                     body + " ] }"}},
              pasted, 0);
  // IS passes values to nodes of every kind.
  check_alike(studio, "values by IS",
              kView +
                  "PROTO P [ field SFColor c 1 1 1 field SFVec3f s 1 1 1 field SFVec2f t 0 0 field SFImage i 0 0 0 ] { "
                  "Shape { appearance Appearance { "
                  "material Material { diffuseColor IS c } texture PixelTexture { image IS i } textureTransform "
                  "TextureTransform { translation IS t } } "
                  "geometry Box { size IS s } } } P { c 0.5 1 0.5 s 2 1 1 t 0.2 0.3 i 2 1 1 0x40 0xff }",
              kView +
                  "Shape { appearance Appearance { material Material { diffuseColor 0.5 1 0.5 } texture PixelTexture { "
                  "image 2 1 1 0x40 0xff } "
                  "textureTransform TextureTransform { translation 0.2 0.3 } } geometry Box { size 2 1 1 } }",
              0);
  check_alike(studio, "lights and materials of a PROTO",
              kView +
                  "PROTO L [ exposedField SFVec3f at 0 0 0 ] { PointLight { location IS at color 1 0 0 } } PROTO M [ "
                  "field SFFloat x 0 ] { Material { shininess IS x specularColor 1 1 1 } } "
                  "L { at 1 1 3 } Shape { appearance Appearance { material M { x 0.5 } } geometry Sphere { } }",
              kView +
                  "PointLight { location 1 1 3 color 1 0 0 } Shape { appearance Appearance { material Material { "
                  "shininess 0.5 specularColor 1 1 1 } } geometry Sphere { } }",
              0);
  CHECK(studio.old_worlds() >= 16);
}

}  // namespace gs::app::pairs_structure_test
