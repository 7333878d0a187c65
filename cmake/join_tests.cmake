# cmake -DOUTPUT=file -DROOT=folder -DTESTS=a_test.cpp,... -P: one source of several tests. What they include comes
# first, since their text stands in a namespace each: helpers of one name do not meet, and headers are read once.
string(REPLACE "," ";" TESTS "${TESTS}")
set(includes "")
set(bodies "")
foreach(test ${TESTS})
  file(STRINGS ${ROOT}/tests/${test} lines REGEX "^#include ")
  list(APPEND includes ${lines})
  string(MAKE_C_IDENTIFIER ${test} name)
  string(APPEND bodies "namespace ${name} {\n#include \"tests/${test}\"\n}\n")
endforeach()
list(REMOVE_DUPLICATES includes)
list(JOIN includes "\n" includes)
file(WRITE ${OUTPUT} "${includes}\n\n${bodies}")
