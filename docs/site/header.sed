1s,^// include/febiodea/febiodea\.h – ,/// \\mainpage FEBioDEA: the C++ library\n/// ,
1s,^// [a-z]*/[^ ]* – ,/// \\file\n/// ,
2,/^[^/]/s,^//\( \|$\),/// ,
