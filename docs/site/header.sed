1s,^// febiodea/febiodea\.h – ,/// \\mainpage FEBioDEA: the C++ library\n/// ,
1s,^// febiodea/[^ ]* – ,/// \\file\n/// ,
2,/^[^/]/s,^//\( \|$\),/// ,
