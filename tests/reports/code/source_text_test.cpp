// SPDX-License-Identifier: MIT
#include "reports/code/source_text.h"

#include <catch2/catch.hpp>

using namespace glint;

TEST_CASE("comments, blanks and line breaks do not count") {
  const std::string code = code_of("int f(int a) {\n  return a + 1;\n}\n");
  CHECK(code == "int f(int a){return a+1;}");
  CHECK(code_of("// what f is\nint f( int a )\n{ return a+1; /* one more */ }") == code);
  CHECK(code_of("int f(int a) { // here\r\n\treturn a\n      + 1;\n}") == code);
}

TEST_CASE("names, numbers and operators do count") {
  const std::string code = code_of("int a = b + +c;");
  CHECK(code_of("int a = b ++c;") != code);
  CHECK(code_of("int aa = b + +c;") != code);
  CHECK(code_of("inta = b + +c;") != code);
  CHECK(code_of("x = 1'000;// and\ny = 'a';") == "x=1'000;y='a';");
}

TEST_CASE("what looks like a comment inside a literal is text, and its blanks count") {
  CHECK(code_of("p = \"http://a  b\"; // c") == "p=\"http://a  b\";");
  CHECK(code_of("p = \"/* a */\";") != code_of("p = \"\";"));
  CHECK(code_of("p = \"a\\\"// b\";") == "p=\"a\\\"// b\";");
  CHECK(code_of("c = '\"'; d = 1; // x") == "c='\"';d=1;");
}

TEST_CASE("raw strings stay as they are") {
  CHECK(code_of("t = R\"(a // b\n  \"c\" )\"; // d") == "t=R\"(a // b\n  \"c\" )\";");
  CHECK(code_of("t = u8R\"x(a )\" // )x\"; /* d */") == "t=u8R\"x(a )\" // )x\";");
  CHECK(code_of("t = R\"(a b)\";") != code_of("t = R\"(a  b)\";"));
}

TEST_CASE("directives keep lines of their own") {
  CHECK(code_of("#define A 1  // one\nint b;") == "#define A 1\nint b;");
  CHECK(code_of("#define A (x)") != code_of("#define A(x)"));
  CHECK(code_of("#define A \\\n  1\nint b;") == "#define A 1\nint b;");
  CHECK(code_of("int b;\n#include <map>\n") == "int b;\n#include <map>");
}

TEST_CASE("includes of the project are those in quotes, outside of comments") {
  const std::string text =
      "#include \"a/b.h\"\n#include <map>\n  #include \"a/c.h\"  // why\n// #include \"a/d.h\"\n"
      "p = \"#include \\\"e.h\";";
  CHECK(quoted_includes(code_of(text)) == std::vector<std::string>{"a/b.h", "a/c.h"});
}
