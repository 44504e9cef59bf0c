# A teacher: figures of the sources, stills for a slide, and what feedback does that feedforward cannot.
flatrig list
flatrig docs flatness > flatness.md
flatrig reproduce K3.21 -o figures
flatrig render overhead --controller ff,ff+pd --scenario load_mass=1.2 --width 240 --height 180 -o stills.png
flatrig compare overhead --scenarios 4 --sets own -o compared
