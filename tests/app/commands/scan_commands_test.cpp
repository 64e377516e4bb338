#include "tests/app/formats/dicom/dicom_builder.h"
#include "tests/app/run_program.h"

#include <string>

using namespace gs::app;
using namespace gs::test;

namespace {

/// Texts of CtSlice that are about the patient.
void check_no_secrets(const std::string& text) {
  for (const char* const secret : {"Secret", "SECRET", "19700102", "1.2.3"})
    CHECK(text.find(secret) == std::string::npos);
}

}  // namespace

TEST_CASE("commands on a DICOM folder show the series and no patient data") {
  const ScratchFolder folder;
  for (int i = 0; i < 3; ++i) {
    CtSlice slice;
    slice.position = "0\\0\\" + std::to_string(2 * i);
    slice.instance = i + 1;
    slice.first = 100 * i;
    folder.write("scan/I" + std::to_string(i), slice.file());
  }
  const std::string scan = quoted(folder.path("scan"));
  const Run text = run("info " + scan);
  CHECK(text.status == 0);
  CHECK_THAT(text.output, Catch::Contains("4 3 3"));
  CHECK_THAT(text.output, Catch::Contains("CT-2"));
  check_no_secrets(text.output);
  check_no_secrets(run("info --json " + scan).output);
  const Run encoded = run("encode --lossless " + scan + ' ' + quoted(folder.path("a.qnv")));
  CHECK(encoded.status == 0);
  check_no_secrets(encoded.output);
  check_no_secrets(folder.read("a.qnv"));
  CHECK(run("export " + scan + ' ' + quoted(folder.path("a.nrrd"))).status == 0);
  check_no_secrets(folder.read("a.nrrd"));
  const Run picture = run("--snapshot " + quoted(folder.path("a.png")) + " --size 40x30 " + scan);
  CHECK(picture.status == 0);
  check_no_secrets(picture.output);
  check_no_secrets(folder.read("a.png"));
}
