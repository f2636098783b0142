# What makes an example of the docs small enough for a test; all else is run as it stands.
s/[[:space:]]+#.*$//
/penumbra synth/{
  s/ --(frames|size) [^ ]+//g
  s/$/ --frames 2 --size 310x94 --overwrite/
}
/penumbra ablate/{
  s/ --(frames|presets|seeds|size) [^ ]+//g
  s/$/ --frames 2 --presets easy --seeds 1 --size 310x94/
}
/penumbra bench dynamics/{
  s/ --(frames|presets|seeds|weights) [^ ]+//g
  s/$/ --frames 2 --presets sitting-static --seeds 1/
}
/penumbra match-eval/{
  s/ --frames [^ ]+//g
  s/$/ --frames 0:4/
}
/penumbra bench network/{
  s/ --weights [^ ]+//g
  s/$/ --weights maskrcnn.safetensors/
}
/penumbra bench (network|conv)/{
  s/ --(size|repeats|warm-up) [^ ]+//g
  s/$/ --size 64x64 --repeats 1 --warm-up 0/
}
/penumbra bench slam/{
  s/ --(street-frames|repeats) [^ ]+//g
  s/$/ --street-frames 3/
}
/penumbra slam .*--weights/{
  s/ --frames [^ ]+//g
  s/$/ --frames 0:4/
}
/penumbra brain train-grid/{
  s/ --(seconds|seeds|modules) [^ ]+//g
  s/$/ --seconds 20 --seeds 1 --modules 1/
}
/penumbra bench brain/{
  s/ --seeds [^ ]+//g
  s/$/ --seeds 1/
}
