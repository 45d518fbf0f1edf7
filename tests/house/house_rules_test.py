#!/usr/bin/env python3
"""Plants violations in a small tree and sees each of them found."""
import tempfile
import unittest
from pathlib import Path

import house_rules

HEADER = "#pragma once\n"
SOUND = {
    "CMakeLists.txt": "",
    "firmware_host/depth_frame.h": HEADER,
    "navproto/include/armature/navproto/subscriber.h": HEADER,
    "sdk/include/armature/sdk/sphere.h": HEADER,
    "tracker/CMakeLists.txt": "add_subdirectory(body)\nadd_subdirectory(forest)\nadd_subdirectory(daemon)\n",
    "tracker/body/skeleton.h": HEADER + '#include "firmware_host/depth_frame.h"\n#include <armature/sdk/sphere.h>\n',
    "tracker/forest/forest.cpp": '#include <vector>\n#include "tracker/body/skeleton.h"\n',
    "tracker/pipeline.h": HEADER + '#include "tracker/body/skeleton.h"\n',
    "tracker/daemon/main.cpp": '#include <armature/navproto/subscriber.h>\n#include "tracker/pipeline.h"\n',
    "tools/listen.cpp": '#include <armature/navproto/subscriber.h>\n#include "tracker/pipeline.h"\n',
} | {f"{folder}/README.md": "what comes in, what goes out\n" for folder in house_rules.FOLDERS}


class HouseRules(unittest.TestCase):
    def found(self, planted=None, links=None, without=None):
        with tempfile.TemporaryDirectory() as folder:
            root = Path(folder)
            for name, text in (SOUND | (planted or {})).items():
                if name == without:
                    continue
                (root / name).parent.mkdir(parents=True, exist_ok=True)
                (root / name).write_text(text)
            file = None
            if links is not None:
                file = root / "links.txt"
                file.write_text("".join("\t".join(row) + "\n" for row in links))
            return house_rules.violations(root, file)

    def assert_found(self, pattern, **planted):
        found = self.found(**planted)
        self.assertEqual(len(found), 1, found)
        self.assertRegex(found[0], pattern)

    def test_a_sound_tree_passes(self):
        self.assertEqual(self.found(), [])

    def test_firmware_host_may_not_include_tracker(self):
        self.assert_found(r"^firmware_host/depth_source.h:2: firmware_host may not include tracker/body/skeleton.h",
                          planted={"firmware_host/depth_source.h": HEADER + '#include "tracker/body/skeleton.h"\n'})

    def test_only_the_daemon_of_tracker_may_include_navproto(self):
        self.assert_found("tracker may not include navproto/",
                          planted={"tracker/body/body.cpp": "#include <armature/navproto/subscriber.h>\n"})

    def test_the_sdk_includes_nothing_else_of_ours(self):
        self.assert_found("sdk may not include",
                          planted={"sdk/mesh.cpp": "  #  include <armature/navproto/subscriber.h>\n"})

    def test_a_panel_stays_under_400_lines(self):
        self.assert_found("a panel of 401 lines", planted={"viewer/app/panels/tall.cpp": "\n" * 401})

    def test_a_panel_changes_nothing_itself(self):
        for line in ("Model& model = *session.models[0];", "ui.commanded.execute(line);", "Session& session = other;",
                     "session.models[i]->selecting.shown = 0;", "++session.models[i]->colour_revision;"):
            self.assert_found("a panel issues commands", planted={"viewer/app/panels/rash.cpp": line + "\n"})
        for line in ("const Model& model = *session.models[0];", "if (models[0]->selecting.shown == 2) return;"):
            self.assertEqual(self.found(planted={"viewer/app/panels/calm.cpp": line + "\n"}), [])

    def test_what_paints_knows_no_geometry(self):
        self.assert_found("leaves geometry to others", planted={"viewer/render/paint.cpp": "#include <armature/sdk/sphere.h>\n"})
        self.assertEqual(self.found(planted={"sdk/include/armature/sdk/error.h": HEADER,
                                             "viewer/render/paint.h": HEADER + "#include <armature/sdk/error.h>\n"}), [])

    def test_the_viewer_may_not_include_the_tracker(self):
        self.assert_found("viewer may not include", planted={"viewer/main.cpp": '#include "tracker/pipeline.h"\n'})

    def test_stages_of_the_tracker_use_only_earlier_stages(self):
        self.assert_found("tracker/body comes before tracker/forest",
                          planted={"tracker/forest/forest.h": HEADER,
                                   "tracker/body/body.cpp": '#include "tracker/forest/forest.h"\n'})

    def test_stages_may_not_include_the_pipeline(self):
        self.assert_found("tracker/forest comes before tracker/ ",
                          planted={"tracker/forest/forest.cpp": '#include "tracker/pipeline.h"\n'})

    def test_nothing_of_the_product_includes_tests(self):
        self.assert_found("tools may not include tests",
                          planted={"tests/support.h": HEADER, "tools/x.cpp": '#include "tests/support.h"\n'})

    def test_include_cycles_are_found(self):
        self.assert_found(r"^include cycle: tracker/body/a.h -> tracker/body/b.h -> tracker/body/a.h",
                          planted={"tracker/body/a.h": HEADER + '#include "tracker/body/b.h"\n',
                                   "tracker/body/b.h": HEADER + '#include "tracker/body/a.h"\n'})

    def test_includes_are_written_from_the_root(self):
        self.assert_found("no path from the project's root", planted={"tools/x.cpp": '#include "listen.h"\n'})

    def test_what_is_installed_is_included_as_installed(self):
        self.assert_found("include <armature/navproto/...>",
                          planted={"tools/x.cpp": '#include "navproto/include/armature/navproto/subscriber.h"\n'})

    def test_links_against_the_arrows_are_found(self):
        self.assert_found("armature_body may not link armature_navproto of navproto",
                          links=[("armature_navproto", "navproto", ""),
                                 ("armature_body", "tracker/body", "Eigen3::Eigen;armature_navproto")])

    def test_links_against_the_order_of_stages_are_found(self):
        self.assert_found("tracker/body comes before tracker/forest",
                          links=[("armature_forest", "tracker/forest", ""),
                                 ("armature_body", "tracker/body", "armature_forest")])

    def test_links_along_the_arrows_pass(self):
        self.assertEqual([], self.found(links=[("armature_navproto", "navproto", ""),
                                               ("armature_body", "tracker/body", ""),
                                               ("armature_pipeline", "tracker", "armature_body"),
                                               ("armatured", "tracker/daemon", "armature_pipeline;armature_navproto"),
                                               ("armature", "tools", "armature_body;armature_navproto")]))

    def test_an_empty_link_graph_is_no_proof(self):
        self.assert_found("names no target", links=[])

    def test_headers_are_included_once(self):
        self.assert_found("no #pragma once", planted={"tools/x.h": "int x;\n"})

    def test_unfinished_work_is_found(self):
        self.assert_found("tools/x.cpp:1: unfinished", planted={"tools/x.cpp": "// TO" + "DO later\n"})

    def test_paths_of_one_machine_are_found(self):
        self.assert_found("a path of one machine", planted={"tools/x.cpp": 'auto f = "/ho' + 'me/me/x";\n'})

    def test_views_that_clang_rejects_are_found(self):
        self.assert_found("sdk/x.cpp:1: a view", planted={"sdk/x.cpp": "v.erase(std::ranges::unique(v).begin());\n"})

    def test_settings_from_the_environment_are_found(self):
        asked = 'const int k = std::getenv("K") ? 1 : 2;\n'
        self.assert_found("sdk/x.cpp:1: a setting from the environment", planted={"sdk/x.cpp": asked})
        self.assertEqual([], self.found(planted={"tools/x.cpp": asked}))
        self.assertEqual([], self.found(planted={"sdk/x.cpp": asked.replace("K\"", "JOURNAL_STREAM\"")}))

    def test_types_of_one_name_are_found(self):
        one = "namespace a::b {\nstruct Fit {\n};\n}  // namespace a::b\n"
        hidden = "namespace a::b {\nnamespace {\nstruct Fit {\n};\n}  // namespace\n}  // namespace a::b\n"
        self.assert_found("sdk/y.cpp:2: a::b::Fit is also the name of a type in sdk/x.cpp",
                          planted={"sdk/x.cpp": one, "sdk/y.cpp": one, "sdk/z.cpp": hidden})

    def test_types_of_one_name_are_found_however_they_are_written(self):
        for begun in ["class Fit final : public Base {", "struct alignas(64) Fit {", "class [[nodiscard]] Fit {",
                      "enum Fit {", "enum class Fit : int {", "struct Fit : public Base,\n             Other {",
                      "struct Fit\n    : public Base {"]:
            other = f"namespace a {{\n{begun}\n}};\n}}  // namespace a\n"
            self.assert_found("sdk/y.cpp:2: a::Fit is also the name of a type in sdk/x.cpp",
                              planted={"sdk/x.cpp": "namespace a {\nstruct Fit {};\n}  // namespace a\n",
                                       "sdk/y.cpp": other})

    def test_types_that_are_only_named_are_no_types_of_one_name(self):
        named = "namespace a {\nstruct Fit;\nenum class Kind : int;\nstruct Fit::Part {};\n}  // namespace a\n"
        self.assertEqual([], list(house_rules.types_of(named)))

    def test_long_sources_and_readmes_are_found(self):
        self.assert_found("split it", planted={"tools/x.cpp": "\n" * 601})
        self.assert_found("40 at most", planted={"tools/README.md": "\n" * 41})

    def test_every_folder_explains_itself(self):
        self.assert_found("tools: has no README.md", without="tools/README.md")

    def test_documents_link_to_what_is_there(self):
        self.assert_found("links to docs/none.svg, which is not there",
                          planted={"ARCHITECTURE.md": "[a](tools/README.md#x) [b](https://c.d) ![e](docs/none.svg)\n"})


if __name__ == "__main__":
    unittest.main()
